#include "generator/segment/flow_kernels.hpp"

#include <bit>
#include <cmath>

#include "generator/segment/simd.hpp"

namespace heart::segment {
namespace {

/// The level set stays within this many voxels: where the sides are decided it would grow without end.
constexpr float bound = 1e6f;

/// 1 / sqrt(s) to 2.2e-5, from a start by integer arithmetic on the exponent and one quadratic step whose constants
/// make the largest error smallest. Multiplications only, so it is several times as fast as a division and a root, and
/// finite at s = 0, where the image is flat (delta in thesis 3.11).
HEART_INLINE float inverse_root(float s) {
  const float start = std::bit_cast<float>(0x5F336908u - (std::bit_cast<std::uint32_t>(s) >> 1));
  const float e = s * start * start;
  return start * (1.91193358f - e * (1.32429278f - e * 0.412339087f));
}

/// The neighbours of a voxel in the order of the axes; where there is none, the voxel itself, with a closed face.
struct Neighbours {
  float x0, x1, y0, y1, z0, z1;
};

struct Open {
  float x = 1, y = 1, z = 1;  ///< upper faces: 1 open, 0 closed
};

HEART_INLINE void faces_at(float u, const Neighbours& n, const Open& open, const FlowConstants& c, const FaceRow& out,
                           std::int64_t i) {
  const float qx = c.along.x * square(n.x1 - n.x0);
  const float qy = c.along.y * square(n.y1 - n.y0);
  const float qz = c.along.z * square(n.z1 - n.z0);
  const float yz = qy + qz;
  out.x[i] = (c.tension.x * open.x) * inverse_root(c.across.x * square(n.x1 - u) + yz);
  out.y[i] = (c.tension.y * open.y) * inverse_root(c.across.y * square(n.y1 - u) + (qx + qz));
  out.z[i] = (c.tension.z * open.z) * inverse_root(c.across.z * square(n.z1 - u) + (qx + qy));
  out.speed[i] = c.time_step * std::sqrt(qx + yz);
}

HEART_INLINE float update_at(float u, const Neighbours& n, const FlowConstants& c, float grey, const FaceRow& f,
                             const float* below_y, const float* below_z, std::int64_t i) {
  const float x0 = f.x[i - 1], x1 = f.x[i], y0 = below_y[i], y1 = f.y[i], z0 = below_z[i], z1 = f.z[i];
  const float pull = larger(-c.force.limit, smaller(c.force.limit, c.force.gain * (grey - c.force.middle)));
  const float neighbours = ((x0 * n.x0 + x1 * n.x1) + (y0 * n.y0 + y1 * n.y1)) + (z0 * n.z0 + z1 * n.z1);
  const float weights = ((x0 + x1) + (y0 + y1)) + (z0 + z1);
  const float speed = f.speed[i];
  return larger(-bound, smaller(bound, (u + speed * (neighbours + pull)) / (1.0f + speed * weights)));
}

HEART_INLINE Neighbours plain_neighbours(const StencilRow& r, std::int64_t l, std::int64_t i, std::int64_t rr) {
  return {r.u[l], r.u[rr], r.below_j[i], r.above_j[i], r.below_k[i], r.above_k[i]};
}

HEART_INLINE float inside(std::uint8_t mask, float there, float here) { return mask ? there : here; }

/// Neighbours outside the domain count as equal.
HEART_INLINE Neighbours masked_neighbours(const FlowRow& f, std::int64_t l, std::int64_t i, std::int64_t r) {
  const float here = f.u.u[i];
  return {inside(f.in[l], f.u.u[l], here),
          inside(f.in[r], f.u.u[r], here),
          inside(f.in_below_j[i], f.u.below_j[i], here),
          inside(f.in_above_j[i], f.u.above_j[i], here),
          inside(f.in_below_k[i], f.u.below_k[i], here),
          inside(f.in_above_k[i], f.u.above_k[i], here)};
}

HEART_INLINE float both(std::uint8_t a, std::uint8_t b) { return a && b ? 1.0f : 0.0f; }

HEART_INLINE void masked_faces_at(const FlowRow& f, std::int64_t l, std::int64_t i, std::int64_t r, const Open& open,
                                  const FlowConstants& c, const FaceRow& out) {
  const Open links{open.x * both(f.in[i], f.in[r]), open.y * both(f.in[i], f.in_above_j[i]),
                   open.z * both(f.in[i], f.in_above_k[i])};
  faces_at(f.u.u[i], masked_neighbours(f, l, i, r), links, c, out, i);
}

/// Calls at(left, i, right, open_x) for the voxels of a row: the ends apart, the others in a loop for the vectoriser.
template <class At>
HEART_INLINE void for_voxels(std::int64_t nx, At&& at) {
  const auto last = nx - 1;
  at(std::int64_t{0}, std::int64_t{0}, last > 0 ? std::int64_t{1} : std::int64_t{0}, last > 0 ? 1.0f : 0.0f);
  HEART_INDEPENDENT
  for (std::int64_t i = 1; i < last; ++i) at(i - 1, i, i + 1, 1.0f);
  if (last > 0) at(last - 1, last, last, 0.0f);
}

HEART_INLINE void faces_body(const FlowRow& row, const FlowConstants& constants, float open_y, float open_z,
                             const FaceRow& faces) {
  const FlowRow r = row;
  const FlowConstants c = constants;
  const FaceRow out = faces;
  for_voxels(r.u.nx, [&](std::int64_t left, std::int64_t i, std::int64_t right, float open_x) HEART_INLINE_LAMBDA {
    faces_at(r.u.u[i], plain_neighbours(r.u, left, i, right), {open_x, open_y, open_z}, c, out, i);
  });
}

HEART_INLINE void masked_faces_body(const FlowRow& row, const FlowConstants& constants, float open_y, float open_z,
                                    const FaceRow& faces) {
  const FlowRow r = row;
  const FlowConstants c = constants;
  const FaceRow out = faces;
  for_voxels(r.u.nx, [&](std::int64_t left, std::int64_t i, std::int64_t right, float open_x) HEART_INLINE_LAMBDA {
    masked_faces_at(r, left, i, right, {open_x, open_y, open_z}, c, out);
  });
}

HEART_INLINE void update_body(const FlowRow& row, const FlowConstants& constants, const float* image,
                              const FaceRow& faces, const float* below_y, const float* below_z) {
  const FlowRow r = row;
  const FlowConstants c = constants;
  const FaceRow f = faces;
  for_voxels(r.u.nx, [&](std::int64_t left, std::int64_t i, std::int64_t right, float) HEART_INLINE_LAMBDA {
    r.u.out[i] = update_at(r.u.u[i], plain_neighbours(r.u, left, i, right), c, image[i], f, below_y, below_z, i);
  });
}

HEART_INLINE void masked_update_body(const FlowRow& row, const FlowConstants& constants, const float* image,
                                     const FaceRow& faces, const float* below_y, const float* below_z) {
  const FlowRow r = row;
  const FlowConstants c = constants;
  const FaceRow f = faces;
  for_voxels(r.u.nx, [&](std::int64_t left, std::int64_t i, std::int64_t right, float) HEART_INLINE_LAMBDA {
    const float now = update_at(r.u.u[i], masked_neighbours(r, left, i, right), c, image[i], f, below_y, below_z, i);
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

}  // namespace heart::segment
