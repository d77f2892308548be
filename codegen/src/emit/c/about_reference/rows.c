
#ifndef GELENK_ABOUT_ROWS
#define GELENK_ABOUT_ROWS
// Multiplies N rows of a matrix from the left by a block-diagonal matrix with one block per joint.
static void gelenk_about_rows(const double *blocks, int columns, double *matrix)
{
    for (int joint = 0; joint < GELENK_JOINTS; ++joint) {
        const int first = GELENK_FIRST_VELOCITIES[joint], entries = GELENK_JOINT_POSITIONS[joint];
        const int size = entries > 1 ? entries - 1 : 1;
        for (int column = 0; column < columns; ++column) {
            double product[6] = {0.0};
            for (int i = 0; i < size; ++i)
                for (int k = 0; k < size; ++k)
                    product[i] += blocks[(first + i) * GELENK_N + first + k] * matrix[(first + k) * columns + column];
            for (int i = 0; i < size; ++i)
                matrix[(first + i) * columns + column] = product[i];
        }
    }
}
#endif
