/* Simulink's part: sizes, one call, and a comparison with the module. */
#include <stdlib.h>
#include <string.h>

#include "ur5_forces.c"

int main(void)
{
    SimStruct block;
    double expected[UR5_N];
    memset(&block, 0, sizeof block);
    mdlInitializeSizes(&block);
    mdlInitializeSampleTimes(&block);
    if (!block.is_contiguous || !block.feeds_through || block.sample_times != 1 || block.period != -1.0)
        return 1;
    block.in = (double *)calloc((size_t)block.input_width, sizeof(double));
    block.out = (double *)calloc((size_t)block.output_width, sizeof(double));
    for (int i = 0; i < block.input_width; ++i)
        block.in[i] = 0.1 * i - 0.7;
    mdlOutputs(&block, 0);
    ur5_inverse_dynamics(block.in, block.in + 6, block.in + 12, expected);
    mdlTerminate(&block);
    return block.input_width != 18 || block.output_width != 6 || memcmp(expected, block.out, sizeof expected) != 0;
}
