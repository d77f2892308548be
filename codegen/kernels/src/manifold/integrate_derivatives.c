{
    // The derivatives are in the frames after the displacement, so they do not depend on the quaternions.
    (void)y;
    for (int i = 0; i < GELENK_N * GELENK_N; ++i) {
        d_dy[i] = 0.0;
        d_dd[i] = 0.0;
    }
    for (int joint = 0; joint < GELENK_JOINTS; ++joint) {
        const int first = GELENK_FIRST_VELOCITIES[joint];
        double by_y[36] = {0.0}, by_d[36] = {0.0};
        const int size = gelenk_joint_tangents(joint, d, by_y, by_d);
        for (int i = 0; i < size; ++i) {
            for (int j = 0; j < size; ++j) {
                const int to = (first + i) * GELENK_N + first + j;
                d_dy[to] = by_y[i * size + j];
                d_dd[to] = by_d[i * size + j];
            }
        }
    }
}
