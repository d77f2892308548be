/* The declarations of FreeRTOS that the page uses, by its documentation: for tests without its source. */
#ifndef FREERTOS_H
#define FREERTOS_H

#include <stddef.h>
#include <stdint.h>

typedef uint32_t StackType_t, TickType_t, UBaseType_t;
typedef int32_t BaseType_t;
#define configMAX_PRIORITIES 8
#define pdMS_TO_TICKS(ms) ((TickType_t)(ms))

#endif
