
#ifndef GELENK_ABOUT_BLOCKS
#define GELENK_ABOUT_BLOCKS
// Product of a matrix and a block-diagonal matrix with one block per joint: N rows, and N columns, or NY
// columns if the columns are position entries.
static void gelenk_about_blocks(int rows, const double *a, const double *blocks, int columns, double *product)
{
    const int are_positions = columns != GELENK_N;
    for (int row = 0; row < rows; ++row)
        for (int joint = 0; joint < GELENK_JOINTS; ++joint) {
            const int entries = GELENK_JOINT_POSITIONS[joint], from = GELENK_FIRST_VELOCITIES[joint];
            const int size = entries > 1 ? entries - 1 : 1, width = are_positions ? entries : size;
            const int to = are_positions ? GELENK_FIRST_POSITIONS[joint] : from;
            for (int j = 0; j < width; ++j) {
                double sum = 0.0;
                for (int k = 0; k < size; ++k)
                    sum += a[row * GELENK_N + from + k] * blocks[(from + k) * columns + to + j];
                product[row * columns + to + j] = sum;
            }
        }
}
#endif
