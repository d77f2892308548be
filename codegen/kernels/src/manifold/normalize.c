{
    bool are_attitudes = true;
    for (int joint = 0; joint < GELENK_JOINTS; ++joint) {
        const int entries = GELENK_JOINT_POSITIONS[joint];
        if (entries > 1 && !gelenk_normalize_quaternion(&y[GELENK_FIRST_POSITIONS[joint] + entries - 4])) {
            are_attitudes = false;
        }
    }
    return are_attitudes;
}
