/* The declarations of Simulink's S-functions that the page uses, by its documentation: for tests without Simulink. */
#ifndef SIMSTRUC_H
#define SIMSTRUC_H

typedef double real_T;
typedef int int_T;

typedef struct {
    int parameters, inputs, outputs, input_width, output_width, is_contiguous, feeds_through, sample_times;
    unsigned options;
    real_T period, offset;
    real_T *in, *out;
} SimStruct;

#define INHERITED_SAMPLE_TIME (-1.0)
#define SS_OPTION_EXCEPTION_FREE_CODE 1u
#define ssSetNumSFcnParams(S, n) ((S)->parameters = (n))
#define ssGetNumSFcnParams(S) ((S)->parameters)
#define ssGetSFcnParamsCount(S) 0
#define ssSetNumInputPorts(S, n) ((S)->inputs = (n))
#define ssSetNumOutputPorts(S, n) ((S)->outputs = (n))
#define ssSetInputPortWidth(S, port, n) ((S)->input_width = (n))
#define ssSetInputPortRequiredContiguous(S, port, yes) ((S)->is_contiguous = (yes))
#define ssSetInputPortDirectFeedThrough(S, port, yes) ((S)->feeds_through = (yes))
#define ssSetOutputPortWidth(S, port, n) ((S)->output_width = (n))
#define ssSetNumSampleTimes(S, n) ((S)->sample_times = (n))
#define ssSetOptions(S, bits) ((S)->options = (bits))
#define ssSetSampleTime(S, index, seconds) ((S)->period = (seconds))
#define ssSetOffsetTime(S, index, seconds) ((S)->offset = (seconds))
#define ssGetInputPortRealSignal(S, port) ((const real_T *)(S)->in)
#define ssGetOutputPortRealSignal(S, port) ((S)->out)

#endif
