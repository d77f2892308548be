// Largest number of doublings of the integral. A period that needs more halvings is divided into equal steps.
#define GELENK_MOST_DOUBLINGS 6

// Largest number of doublings of a step.
#define GELENK_MOST_REPETITIONS 18

// Number of terms in each of the three parts of the Taylor polynomial.
#define GELENK_TERMS 6

// Coefficients 1/(k + 1)! of the Taylor polynomial.
#define GELENK_FACTORIAL_6 (1.0 / 2.0 / 3.0 / 4.0 / 5.0 / 6.0)
#define GELENK_FACTORIAL_12 (GELENK_FACTORIAL_6 / 7.0 / 8.0 / 9.0 / 10.0 / 11.0 / 12.0)
static const double gelenk_coefficients[3][GELENK_TERMS] = {
    {
        1.0,
        1.0 / 2.0,
        1.0 / 2.0 / 3.0,
        1.0 / 2.0 / 3.0 / 4.0,
        1.0 / 2.0 / 3.0 / 4.0 / 5.0,
        GELENK_FACTORIAL_6,
    },
    {
        GELENK_FACTORIAL_6 / 7.0,
        GELENK_FACTORIAL_6 / 7.0 / 8.0,
        GELENK_FACTORIAL_6 / 7.0 / 8.0 / 9.0,
        GELENK_FACTORIAL_6 / 7.0 / 8.0 / 9.0 / 10.0,
        GELENK_FACTORIAL_6 / 7.0 / 8.0 / 9.0 / 10.0 / 11.0,
        GELENK_FACTORIAL_12,
    },
    {
        GELENK_FACTORIAL_12 / 13.0,
        GELENK_FACTORIAL_12 / 13.0 / 14.0,
        GELENK_FACTORIAL_12 / 13.0 / 14.0 / 15.0,
        GELENK_FACTORIAL_12 / 13.0 / 14.0 / 15.0 / 16.0,
        GELENK_FACTORIAL_12 / 13.0 / 14.0 / 15.0 / 16.0 / 17.0,
        GELENK_FACTORIAL_12 / 13.0 / 14.0 / 15.0 / 16.0 / 17.0 / 18.0,
    },
};

// The largest sum of magnitudes in a row.
static double gelenk_norm(const double *matrix)
{
    double largest = 0.0;
    for (int i = 0; i < GELENK_N; ++i) {
        double sum = 0.0;
        for (int j = 0; j < GELENK_N; ++j) {
            sum += fabs(matrix[i * GELENK_N + j]);
        }
        if (sum > largest) {
            largest = sum;
        }
    }
    return largest;
}

// Number of halvings of the period until nu h <= 5/4 for the halved period h. Returns -1 if this number
// exceeds the largest number of doublings of the integral and of steps.
//
// nu is a bound for the rates of the system, the positive root of nu^2 = b nu + a with the norms a and b of
// the derivatives with respect to y and v. With t = h / (5/4), the condition is equivalent to (a t + b) t <=
// 1.
static int gelenk_halvings(const double *by_y, const double *by_v, double period)
{
    const double a = gelenk_norm(by_y);
    const double b = gelenk_norm(by_v);
    double t = period / 1.25;
    int halvings = 0;
    while ((a * t + b) * t > 1.0) {
        if (halvings == GELENK_MOST_DOUBLINGS + GELENK_MOST_REPETITIONS) {
            return -1;
        }
        t *= 0.5;
        ++halvings;
    }
    return halvings;
}

// The matrix [A_y A_v] with scaled blocks.
static void gelenk_lower_half(const double *by_y, double unit_y, const double *by_v, double unit_v, double *lower)
{
    for (int i = 0; i < GELENK_N; ++i) {
        for (int j = 0; j < GELENK_N; ++j) {
            lower[i * GELENK_ROW + j] = by_y[i * GELENK_N + j] * unit_y;
            lower[i * GELENK_ROW + GELENK_N + j] = by_v[i * GELENK_N + j] * unit_v;
        }
    }
}

// The product [L R] A = [0 L] + R [A_y A_v].
static void gelenk_times_system(const double *half, const double *lower, double *result)
{
    for (int i = 0; i < GELENK_N; ++i) {
        const double *from = &half[i * GELENK_ROW];
        double *to = &result[i * GELENK_ROW];
        for (int j = 0; j < GELENK_N; ++j) {
            to[j] = 0.0;
            to[GELENK_N + j] = from[j];
        }
        gelenk_add_row(to, &from[GELENK_N], lower);
    }
}

// The sum of the terms of one part of the polynomial.
static void gelenk_combination(const double *coefficients, double powers[][GELENK_HALF], double *sum)
{
    for (int i = 0; i < GELENK_HALF; ++i) {
        sum[i] = 0.0;
    }
    for (int k = 0; k < GELENK_TERMS; ++k) {
        gelenk_add_scaled(GELENK_HALF, sum, coefficients[k], powers[k]);
    }
}

// The upper half of the integral of exp(A s) over one unit of time. It is the sum of A^k/(k + 1)! up to k =
// 17, in three parts with the common factor A^6 (Paterson and Stockmeyer 1973).
static void gelenk_taylor(const double *lower, double *sum)
{
    // Upper halves of A^k. The upper half of A^7 is the lower half of A^6.
    double powers[GELENK_TERMS + 2][GELENK_HALF];
    for (int k = 0; k < 2; ++k) {
        for (int i = 0; i < GELENK_HALF; ++i) {
            powers[k][i] = 0.0;
        }
        for (int i = 0; i < GELENK_N; ++i) {
            powers[k][i * GELENK_ROW + k * GELENK_N + i] = 1.0;
        }
    }
    memcpy(powers[2], lower, sizeof powers[2]);
    for (int k = 2; k <= GELENK_TERMS; ++k) {
        gelenk_times_system(powers[k], lower, powers[k + 1]);
    }
    gelenk_combination(gelenk_coefficients[2], powers, sum);
    for (int part = 1; part >= 0; --part) {
        double next[GELENK_HALF];
        gelenk_combination(gelenk_coefficients[part], powers, next);
        for (int i = 0; i < GELENK_N; ++i) {
            const double *from = &sum[i * GELENK_ROW];
            gelenk_add_row(&next[i * GELENK_ROW], from, powers[GELENK_TERMS]);
            gelenk_add_row(&next[i * GELENK_ROW], &from[GELENK_N], powers[GELENK_TERMS + 1]);
        }
        memcpy(sum, next, sizeof next);
    }
}

// The upper half of the integral I over twice the time: 2 I + (I A) I.
static void gelenk_double_integral(const double *lower, double *integral)
{
    double change[GELENK_HALF], next[GELENK_HALF] = {0.0};
    gelenk_times_system(integral, lower, change);
    gelenk_add_scaled(GELENK_HALF, next, 2.0, integral);
    for (int i = 0; i < GELENK_N; ++i) {
        // The blocks of the lower half of I are obtained from the change I A, because exp(A t) = 1 + A I.
        gelenk_add_row(&next[i * GELENK_ROW], &change[i * GELENK_ROW], integral);
        gelenk_add_row(&next[i * GELENK_ROW], &change[i * GELENK_ROW + GELENK_N], change);
    }
    memcpy(integral, next, sizeof next);
}

// The halves of A_d - 1, B_d and c_d over a time t with nu t <= 80. nu is a bound for the rates of the
// system.
//
// With A = [0 1; A_y A_v], all results follow from the upper half [C P] of the integral I of exp(A s). exp(A
// t) is 1 + I A. Its upper half is [1 0] + [C P] A = [1 + X, Q], and its lower half is [0 1] + [X Q] A. B_d
// is [P B_x; Q B_x]. The integral is computed by scaling and squaring (Higham, Functions of Matrices, 2008,
// section 10.3): it is known for a short time h with nu h <= 5/4, and is doubled `doublings` times.
static void gelenk_held(const double *by_y, const double *by_v, const double *by_u, const double *remainder,
    double time, int doublings, double change[2][GELENK_HALF], double *input, double *affine)
{
    // The unit of time is the short time h, so v is scaled to h v.
    const double h = time / (double)(1u << doublings);
    double lower[GELENK_HALF], integral[GELENK_HALF];
    gelenk_lower_half(by_y, h * h, by_v, h, lower);
    gelenk_taylor(lower, integral);
    for (int k = 0; k < doublings; ++k) {
        gelenk_double_integral(lower, integral);
    }
    gelenk_times_system(integral, lower, change[0]);
    gelenk_lower_half(by_y, h, by_v, h, lower);
    gelenk_times_system(change[0], lower, change[1]);
    for (int i = 0; i < GELENK_N; ++i) {
        double by_acceleration[2][GELENK_N];
        for (int j = 0; j < GELENK_N; ++j) {
            change[0][i * GELENK_ROW + GELENK_N + j] *= h;
            by_acceleration[0][j] = integral[i * GELENK_ROW + GELENK_N + j] * (h * h);
            by_acceleration[1][j] = change[0][i * GELENK_ROW + GELENK_N + j];
        }
        for (int half = 0; half < 2; ++half) {
            double *row = &input[(half * GELENK_N + i) * GELENK_M];
            for (int j = 0; j < GELENK_M; ++j) {
                row[j] = 0.0;
            }
            gelenk_add_combination(row, by_acceleration[half], by_u);
            affine[half * GELENK_N + i] = gelenk_dot_product(GELENK_N, by_acceleration[half], remainder);
        }
    }
}

// Combines two steps to one: over twice the time, A_d - 1, B_d and c_d become 2 (A_d - 1) + (A_d - 1)^2, 2
// B_d + (A_d - 1) B_d and 2 c_d + (A_d - 1) c_d.
static void gelenk_twice(double change[2][GELENK_HALF], double *input, double *affine)
{
    double next[2][GELENK_HALF] = {{0.0}}, next_input[2 * GELENK_BY_INPUTS] = {0.0};
    double next_affine[GELENK_ROW] = {0.0};
    for (int half = 0; half < 2; ++half) {
        gelenk_add_scaled(GELENK_HALF, next[half], 2.0, change[half]);
        gelenk_add_scaled(GELENK_N, &next_affine[half * GELENK_N], 2.0, &affine[half * GELENK_N]);
        for (int i = 0; i < GELENK_N; ++i) {
            const int row = half * GELENK_N + i;
            gelenk_add_scaled(GELENK_M, &next_input[row * GELENK_M], 2.0, &input[row * GELENK_M]);
            for (int block = 0; block < 2; ++block) {
                const double *from = &change[half][i * GELENK_ROW + block * GELENK_N];
                gelenk_add_row(&next[half][i * GELENK_ROW], from, change[block]);
                gelenk_add_combination(&next_input[row * GELENK_M], from, &input[block * GELENK_N * GELENK_M]);
                next_affine[row] += gelenk_dot_product(GELENK_N, from, &affine[block * GELENK_N]);
            }
        }
    }
    memcpy(change[0], next[0], sizeof next[0]);
    memcpy(change[1], next[1], sizeof next[1]);
    memcpy(input, next_input, 2 * GELENK_N * GELENK_M * sizeof *input);
    memcpy(affine, next_affine, sizeof next_affine);
}

// Exact solution of x' = A x + B_x u + c over a period with constant inputs.
//
// The solution over a part of the period is `held`. The part is so short that `held` is accurate. Two equal
// steps are combined to one of twice the time until the period is reached. Every entry is infinite if the
// largest number of doublings of steps does not suffice.
static void gelenk_zero_order_hold(const double *by_y, const double *by_v, const double *by_u, const double *remainder,
    double period, double *state, double *input, double *affine)
{
    double change[2][GELENK_HALF];
    const int halvings = gelenk_halvings(by_y, by_v, period);
    if (halvings < 0) {
        for (int i = 0; i < 2 * GELENK_HALF; ++i) {
            state[i] = INFINITY;
        }
        for (int i = 0; i < 2 * GELENK_N * GELENK_M; ++i) {
            input[i] = INFINITY;
        }
        for (int i = 0; i < GELENK_ROW; ++i) {
            affine[i] = INFINITY;
        }
        return;
    }
    const int repetitions = halvings > GELENK_MOST_DOUBLINGS ? halvings - GELENK_MOST_DOUBLINGS : 0;
    const double time = period / (double)(1u << repetitions);
    gelenk_held(by_y, by_v, by_u, remainder, time, halvings - repetitions, change, input, affine);
    for (int k = 0; k < repetitions; ++k) {
        gelenk_twice(change, input, affine);
    }
    for (int half = 0; half < 2; ++half) {
        for (int block = 0; block < 2; ++block) {
            double *to = &state[(half * 2 + block) * GELENK_N * GELENK_N];
            for (int i = 0; i < GELENK_N; ++i) {
                for (int j = 0; j < GELENK_N; ++j) {
                    to[i * GELENK_N + j] = change[half][i * GELENK_ROW + block * GELENK_N + j];
                }
                if (half == block) {
                    to[i * GELENK_N + i] += 1.0;
                }
            }
        }
    }
}
