// The elementary functions, computed from IEEE additions, multiplications, divisions and square roots alone:
// the same bits on every machine, which the C library's do not promise. Nothing that a picture depends on
// may call std::sin and its like.
#pragma once

namespace tessera::core {

inline constexpr float kPi = 3.14159265358979323846f;

// Sine and cosine of an angle in radians, |x| <= 1e4. Error below 1e-7 absolute.
float sin(float x);
float cos(float x);
// In [-pi, pi]; atan2(0, 0) is 0. Error below 1e-6 absolute.
float atan2(float y, float x);

// In double precision, relative error below 1e-13 (log: absolute, for results near 0).
double exp(double x);                      // 0 below -708, infinity above 709
double log(double x);                      // x > 0
double pow(double base, double exponent);  // base >= 0; pow(0, positive) is 0, pow(x, 0) is 1

}  // namespace tessera::core
