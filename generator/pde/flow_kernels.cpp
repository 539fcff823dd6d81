// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/flow_kernels.hpp"

#include <bit>
#include <cmath>

#include "generator/pde/row_loops.hpp"

namespace heartgen::pde {
namespace {

/// factor / sqrt(s) to 2.2e-5, from a start by integer arithmetic on the exponent and one quadratic step whose
/// constants make the largest error smallest. Multiplications only, so it is several times as fast as a division and a
/// root, and finite at s = 0, where the image is flat (delta in thesis 3.11). The factor is part of the step's
/// constants.
struct InverseRoot {
  float c0, c1, c2;

  HEARTGEN_INLINE explicit InverseRoot(float factor)
      : c0(factor * 1.91193358f), c1(factor * 1.32429278f), c2(factor * 0.412339087f) {}

  HEARTGEN_INLINE float operator()(float s) const {
    const float start = std::bit_cast<float>(0x5F336908u - (std::bit_cast<std::uint32_t>(s) >> 1));
    const float e = s * start * start;
    return start * (c0 - e * (c1 - e * c2));
  }
};

/// The neighbours of a voxel in the order of the axes; where there is none, the voxel itself, with a closed face.
struct Neighbours {
  float x0, x1, y0, y1, z0, z1;
};

/// A row's constants; the factors of closed faces are 0.
struct Tensions {
  InverseRoot x, y, z;
};

HEARTGEN_INLINE void faces_at(float u, const Neighbours& n, const Tensions& t, const FlowConstants& c,
                              const FaceRow& out, std::int64_t i) {
  const float qx = c.along.x * square(n.x1 - n.x0);
  const float qy = c.along.y * square(n.y1 - n.y0);
  const float qz = c.along.z * square(n.z1 - n.z0);
  const float yz = qy + qz;
  out.x[i] = t.x(c.across.x * square(n.x1 - u) + yz);
  out.y[i] = t.y(c.across.y * square(n.y1 - u) + (qx + qz));
  out.z[i] = t.z(c.across.z * square(n.z1 - u) + (qx + qy));
  out.speed[i] = c.time_step * std::sqrt(qx + yz);
}

HEARTGEN_INLINE float update_at(float u, const Neighbours& n, const FlowConstants& c, float grey, const FaceRow& f,
                                const float* below_y, const float* below_z, std::int64_t i) {
  const float x0 = f.x[i - 1], x1 = f.x[i], y0 = below_y[i], y1 = f.y[i], z0 = below_z[i], z1 = f.z[i];
  const float pull = larger(-c.force.limit, smaller(c.force.limit, c.force.gain * (grey - c.force.middle)));
  const float neighbours = ((x0 * n.x0 + x1 * n.x1) + (y0 * n.y0 + y1 * n.y1)) + (z0 * n.z0 + z1 * n.z1);
  const float weights = ((x0 + x1) + (y0 + y1)) + (z0 + z1);
  const float speed = f.speed[i];
  return larger(-c.bound, smaller(c.bound, (u + speed * (neighbours + pull)) / (1.0f + speed * weights)));
}

HEARTGEN_INLINE Neighbours plain_neighbours(const StencilRow& r, std::int64_t i) {
  return {r.u[i - 1], r.u[i + 1], r.below_j[i], r.above_j[i], r.below_k[i], r.above_k[i]};
}

HEARTGEN_INLINE float inside(std::uint8_t mask, float there, float here) { return mask ? there : here; }

/// Neighbours outside the domain count as equal.
HEARTGEN_INLINE Neighbours masked_neighbours(const FlowRow& f, std::int64_t i) {
  const float here = f.u.u[i];
  return {inside(f.in[i - 1], f.u.u[i - 1], here),       inside(f.in[i + 1], f.u.u[i + 1], here),
          inside(f.in_below_j[i], f.u.below_j[i], here), inside(f.in_above_j[i], f.u.above_j[i], here),
          inside(f.in_below_k[i], f.u.below_k[i], here), inside(f.in_above_k[i], f.u.above_k[i], here)};
}

HEARTGEN_INLINE float both(std::uint8_t a, std::uint8_t b) { return a && b ? 1.0f : 0.0f; }

HEARTGEN_INLINE Tensions tensions(const FlowConstants& c, float open_y, float open_z) {
  return {InverseRoot(c.tension.x), InverseRoot(c.tension.y * open_y), InverseRoot(c.tension.z * open_z)};
}

HEARTGEN_INLINE void faces_body(const FlowRow& row, const FlowConstants& constants, float open_y, float open_z,
                                const FaceRow& faces) {
  const FlowRow r = row;
  const FlowConstants c = constants;
  const FaceRow out = faces;
  const Tensions t = tensions(c, open_y, open_z);
  for_blocks(r.u.nx, [&](std::int64_t i)
                         HEARTGEN_INLINE_LAMBDA { faces_at(r.u.u[i], plain_neighbours(r.u, i), t, c, out, i); });
  out.x[r.u.nx - 1] = 0.0f;
}

HEARTGEN_INLINE void masked_faces_body(const FlowRow& row, const FlowConstants& constants, float open_y, float open_z,
                                       const FaceRow& faces) {
  const FlowRow r = row;
  const FlowConstants c = constants;
  const FaceRow out = faces;
  const Tensions t = tensions(c, open_y, open_z);
  for_blocks(r.u.nx, [&](std::int64_t i) HEARTGEN_INLINE_LAMBDA {
    faces_at(r.u.u[i], masked_neighbours(r, i), t, c, out, i);
    out.x[i] *= both(r.in[i], r.in[i + 1]);
    out.y[i] *= both(r.in[i], r.in_above_j[i]);
    out.z[i] *= both(r.in[i], r.in_above_k[i]);
  });
  out.x[r.u.nx - 1] = 0.0f;
}

HEARTGEN_INLINE void update_body(const FlowRow& row, const FlowConstants& constants, const float* image,
                                 const FaceRow& faces, const float* below_y, const float* below_z) {
  const FlowRow r = row;
  const FlowConstants c = constants;
  const FaceRow f = faces;
  for_blocks(r.u.nx, [&](std::int64_t i) HEARTGEN_INLINE_LAMBDA {
    r.u.out[i] = update_at(r.u.u[i], plain_neighbours(r.u, i), c, image[i], f, below_y, below_z, i);
  });
}

HEARTGEN_INLINE void masked_update_body(const FlowRow& row, const FlowConstants& constants, const float* image,
                                        const FaceRow& faces, const float* below_y, const float* below_z) {
  const FlowRow r = row;
  const FlowConstants c = constants;
  const FaceRow f = faces;
  for_blocks(r.u.nx, [&](std::int64_t i) HEARTGEN_INLINE_LAMBDA {
    const float now = update_at(r.u.u[i], masked_neighbours(r, i), c, image[i], f, below_y, below_z, i);
    r.u.out[i] = r.in[i] ? now : r.u.u[i];
  });
}

}  // namespace

void flow_faces(const FlowRow& row, const FlowConstants& constants, float open_y, float open_z, const FaceRow& faces) {
  if (row.in)
    vectorised<masked_faces_body>(row, constants, open_y, open_z, faces);
  else
    vectorised<faces_body>(row, constants, open_y, open_z, faces);
}

void flow_update(const FlowRow& row, const FlowConstants& constants, const float* image, const FaceRow& faces,
                 const float* below_y, const float* below_z) {
  if (row.in)
    vectorised<masked_update_body>(row, constants, image, faces, below_y, below_z);
  else
    vectorised<update_body>(row, constants, image, faces, below_y, below_z);
}

}  // namespace heartgen::pde
