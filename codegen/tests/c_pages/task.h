/* The part of `FreeRTOS.h` with tasks. */
#ifndef TASK_H
#define TASK_H

typedef void *TaskHandle_t;
typedef void (*TaskFunction_t)(void *);
void vPortTaskUsesFPU(void);
#define portTASK_USES_FLOATING_POINT() vPortTaskUsesFPU()
TickType_t xTaskGetTickCount(void);
void vTaskDelayUntil(TickType_t *woken, TickType_t ticks);
BaseType_t xTaskCreate(TaskFunction_t task, const char *name, uint16_t words, void *argument, UBaseType_t priority, TaskHandle_t *made);

#endif
