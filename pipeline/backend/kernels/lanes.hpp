// Double-precision lanes as the compiler's own vectors: each instruction set uses the widest registers it has, and the
// sums are the same in all. Only for *.kernel.cpp.
#pragma once

#include "pipeline/backend/kernels/kernels.hpp"

#define POVSLAM_INLINE static inline __attribute__((always_inline, unused))

namespace povslam::POVSLAM_ISA {

typedef double Lanes __attribute__((vector_size(sizeof(double) * kVemLanes), may_alias));
typedef int64_t Bits __attribute__((vector_size(sizeof(int64_t) * kVemLanes), may_alias));

POVSLAM_INLINE Lanes fill(double a) {
  return Lanes{a, a, a, a};
}
POVSLAM_INLINE const Lanes& lanes(const Quad& quad) {
  return *reinterpret_cast<const Lanes*>(&quad);
}
POVSLAM_INLINE Lanes& lanes(Quad& quad) {
  return *reinterpret_cast<Lanes*>(&quad);
}
POVSLAM_INLINE Lanes select(Bits mask, Lanes yes, Lanes no) {
  return reinterpret_cast<Lanes>((reinterpret_cast<Bits>(yes) & mask) | (reinterpret_cast<Bits>(no) & ~mask));
}
POVSLAM_INLINE double sum(Lanes a) {
  return (a[0] + a[1]) + (a[2] + a[3]);
}

struct Lanes3 {
  Lanes x, y, z;
};
POVSLAM_INLINE Lanes3 load3(const Quad* quads) {
  return {lanes(quads[0]), lanes(quads[1]), lanes(quads[2])};
}
POVSLAM_INLINE Lanes3 operator-(const Lanes3& a, const Lanes3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
POVSLAM_INLINE Lanes dot(const Lanes3& a, const Lanes3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
POVSLAM_INLINE void add_scaled(Lanes3& sum, Lanes weight, const Lanes3& a) {
  sum.x += weight * a.x;
  sum.y += weight * a.y;
  sum.z += weight * a.z;
}
// R_p: 9 of the rotation by row, 3 of the position.
POVSLAM_INLINE Lanes3 rotate(const double* R_p, const Lanes3& d) {
  return {R_p[0] * d.x + R_p[1] * d.y + R_p[2] * d.z, R_p[3] * d.x + R_p[4] * d.y + R_p[5] * d.z,
          R_p[6] * d.x + R_p[7] * d.y + R_p[8] * d.z};
}
POVSLAM_INLINE Lanes3 shift(const double* p, const Lanes3& a) {
  return {a.x + p[0], a.y + p[1], a.z + p[2]};
}
POVSLAM_INLINE Lanes3 turn(const VemPlaces& places, const Lanes3& l) {
  return {places.cos_yaw * l.x - places.sin_yaw * l.y, places.sin_yaw * l.x + places.cos_yaw * l.y, l.z};
}

}  // namespace povslam::POVSLAM_ISA
