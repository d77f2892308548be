{
    for (int joint = 0; joint < GELENK_JOINTS; ++joint) {
        const double *from = &y[GELENK_FIRST_POSITIONS[joint]], *by = &d[GELENK_FIRST_VELOCITIES[joint]];
        double *to = &y_next[GELENK_FIRST_POSITIONS[joint]];
        if (GELENK_JOINT_POSITIONS[joint] == 7) {
            gelenk_pose_after(from, by, to);
        } else if (GELENK_JOINT_POSITIONS[joint] == 4) {
            double half[6];
            gelenk_stumpff(0.25 * gelenk_inner(by, by), half);
            gelenk_attitude_after(from, by, half, to);
        } else {
            *to = *from + *by;
        }
    }
}
