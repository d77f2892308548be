// The laws of a robot in single precision, as measure.c calls them: law.c has them in C, law.rs in Rust.

#ifndef LAW_H
#define LAW_H

#include "robot.h"

// A desired motion at one time: positions, velocities, accelerations.
struct sample {
    float positions[ROBOT_N];
    float velocities[ROBOT_N];
    float accelerations[ROBOT_N];
};

// Gains for joints of natural frequency omega [rad/s] and damping ratio `damping` at rest: K_p = M_ii omega^2,
// K_d = 2 damping M_ii omega, with M at `positions`.
void prepare(const float *positions, float omega, float damping);

// M a + k - q [N m or N].
void inverse_dynamics(const struct sample *desired, float *forces);

// u = B^-1 (M a + k - q).
void feed_forward(const struct sample *desired, float *inputs);

// u = B^-1 (M a + k - q + K_p (y_d - y) + K_d (v_d - v)).
void joint_pd(const struct sample *desired, const float *positions, const float *velocities, float *inputs);

#endif
