/* What modules in C take of <math.h>, all of them instructions: Debian's compiler for Cortex-M comes without a C library. */
#ifndef MATH_H
#define MATH_H

#define INFINITY __builtin_inff()
#define NAN __builtin_nanf("")
#define copysignf __builtin_copysignf
#define fabsf __builtin_fabsf
#define fmaf __builtin_fmaf
#define sqrtf __builtin_sqrtf

#endif
