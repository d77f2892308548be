/* Lets the robot of robot.toml fall and tumble, and prints its motion. */

#include <stdio.h>

#include "robot.h"

/* Step of the integration in s. */
static const double STEP = 1e-3;
/* Number of steps. */
static const int STEPS = 1000;
/* Number of steps between two printed lines. */
static const int PRINTED = 100;

static void print(double time, const double *y, const double *v)
{
    printf("%8.3f", time);
    for (int i = 0; i < ROBOT_NY; ++i)
        printf("  %12.6f", y[i]);
    printf("  %12.6f\n", robot_kinetic_energy(y, v) + robot_potential_energy(y));
}

/* Computes the inputs u. Replace this function by your controller. */
static void inputs(const double *y, const double *v, double *u)
{
    (void)y;
    (void)v;
    for (int i = 0; i < ROBOT_M; ++i)
        u[i] = 0.0;
}

int main(void)
{
    /* The robot starts at its neutral positions, and its base turns at 1 rad/s about its x axis. */
    double y[ROBOT_NY];
    double v[ROBOT_N] = {0.0, 0.0, 0.0, 1.0};

    for (int i = 0; i < ROBOT_NY; ++i)
        y[i] = ROBOT_NEUTRAL[i];
    printf("%8s", "t [s]");
    for (int i = 0; i < ROBOT_NY; ++i)
        printf("  %12s", ROBOT_POSITION_NAMES[i]);
    printf("  %12s\n", "energy [J]");
    for (int step = 0; step <= STEPS; ++step) {
        double u[ROBOT_M + 1], y_next[ROBOT_NY], v_next[ROBOT_N];
        if (step % PRINTED == 0)
            print(step * STEP, y, v);
        inputs(y, v, u);
        robot_step(y, v, u, STEP, y_next, v_next);
        for (int i = 0; i < ROBOT_NY; ++i)
            y[i] = y_next[i];
        for (int i = 0; i < ROBOT_N; ++i)
            v[i] = v_next[i];
    }
    return 0;
}
