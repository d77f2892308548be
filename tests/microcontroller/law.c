// The laws in C, over a module that gelenk wrote. B is diagonal: each drive moves one joint.

#include "law.h"

static float inverse_input_matrix[ROBOT_N];
static float position_gains[ROBOT_N];
static float velocity_gains[ROBOT_N];

void prepare(const float *positions, float omega, float damping)
{
    float b[ROBOT_N * ROBOT_N], m[ROBOT_N * ROBOT_N];
    robot_input_matrix(b);
    robot_mass_matrix(positions, m);
    for (int i = 0; i < ROBOT_N; ++i) {
        const float mass = m[i * ROBOT_N + i];
        inverse_input_matrix[i] = 1.0f / b[i * ROBOT_N + i];
        position_gains[i] = mass * omega * omega;
        velocity_gains[i] = 2.0f * damping * mass * omega;
    }
}

void inverse_dynamics(const struct sample *desired, float *forces)
{
    robot_inverse_dynamics(desired->positions, desired->velocities, desired->accelerations, forces);
}

void feed_forward(const struct sample *desired, float *inputs)
{
    float forces[ROBOT_N];
    inverse_dynamics(desired, forces);
    for (int i = 0; i < ROBOT_N; ++i) {
        inputs[i] = inverse_input_matrix[i] * forces[i];
    }
}

void joint_pd(const struct sample *desired, const float *positions, const float *velocities, float *inputs)
{
    float forces[ROBOT_N];
    inverse_dynamics(desired, forces);
    for (int i = 0; i < ROBOT_N; ++i) {
        const float correction = position_gains[i] * (desired->positions[i] - positions[i])
            + velocity_gains[i] * (desired->velocities[i] - velocities[i]);
        inputs[i] = inverse_input_matrix[i] * (forces[i] + correction);
    }
}
