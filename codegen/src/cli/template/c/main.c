/* Lets the robot of robot.toml swing and prints its motion. */

#include <stdio.h>

#include "robot.h"

/* Step of the integration in s. */
static const double STEP = 1e-3;
/* Number of steps. */
static const int STEPS = 4000;
/* Number of steps between two printed lines. */
static const int PRINTED = 200;

static void print(double time, const double *y, const double *v)
{
    printf("%8.3f", time);
    for (int i = 0; i < ROBOT_N; ++i)
        printf("  %12.6f", y[i]);
    printf("  %12.6f\n", robot_kinetic_energy(y, v) + robot_potential_energy(y));
}

/* Computes the inputs u of the motors. Replace this function by your controller. */
static void inputs(const double *y, const double *v, double *u)
{
    (void)y;
    (void)v;
    for (int i = 0; i < ROBOT_M; ++i)
        u[i] = 0.0;
}

int main(void)
{
    /* The robot starts at rest, with the first joint at 1 rad (or 1 m). */
    double y[ROBOT_N] = {1.0};
    double v[ROBOT_N] = {0.0};

    printf("%8s", "t [s]");
    for (int i = 0; i < ROBOT_N; ++i)
        printf("  %12s", ROBOT_JOINT_NAMES[i]);
    printf("  %12s\n", "energy [J]");
    for (int step = 0; step <= STEPS; ++step) {
        double u[ROBOT_M], y_next[ROBOT_N], v_next[ROBOT_N];
        if (step % PRINTED == 0)
            print(step * STEP, y, v);
        inputs(y, v, u);
        robot_step(y, v, u, STEP, y_next, v_next);
        for (int i = 0; i < ROBOT_N; ++i) {
            y[i] = y_next[i];
            v[i] = v_next[i];
        }
    }
    return 0;
}
