{
    for (int joint = 0; joint < GELENK_JOINTS; ++joint) {
        const int position = GELENK_FIRST_POSITIONS[joint];
        double *result = &d[GELENK_FIRST_VELOCITIES[joint]];
        if (GELENK_JOINT_POSITIONS[joint] == 7) {
            gelenk_twist_between(&from[position], &to[position], result);
        } else if (GELENK_JOINT_POSITIONS[joint] == 4) {
            double back[4], relative[4];
            gelenk_conjugate(&from[position], back);
            gelenk_quaternion_product(back, &to[position], relative);
            gelenk_rotation_vector(relative, result);
        } else {
            *result = to[position] - from[position];
        }
    }
}
