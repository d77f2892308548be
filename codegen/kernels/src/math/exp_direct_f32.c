// exp x for |x| <= 110, relative error below 2^-32, with a short minimax polynomial (Remez exchange).
GELENK_INLINE double gelenk_exp_direct_f32(double x)
{
    const double to_integer = 6755399441055744.0; // 1.5 * 2^52: the sum's last bits are the nearest integer
    const double shifted = x * 1.4426950408889634 + to_integer;
    const double r = x - (shifted - to_integer) * 0.6931471805599453;
    const double r2 = r * r;
    const double p = (0.500000004303789 + r * 0.16666666822963463)
        + r2 * ((0.04166635736369276 + r * 0.008333271724051775)
                + r2 * (0.0013941060088417158 + r * 0.00019914865185100252));
    const double power = gelenk_from_bits((gelenk_bits(shifted) - gelenk_bits(to_integer) + 1023) << 52);
    return (1.0 + (r + r2 * p)) * power;
}
