#include "ooc/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "ooc/check.h"

namespace cuesta {
namespace {

bool is_finite(const LocalTransform& local) {
  if (const Trs* t = std::get_if<Trs>(&local)) {
    return is_finite(t->translation) && is_finite(t->scale) &&
           std::all_of(t->rotation.begin(), t->rotation.end(), [](double x) { return std::isfinite(x); });
  }
  const Affine& a = std::get<Affine>(local);
  return is_finite(a.translation) && std::all_of(a.columns.begin(), a.columns.end(),
                                                 [](const Vec3d& column) { return is_finite(column); });
}

std::string node_fault(const Scene& scene, std::size_t i, std::uint64_t parts) {
  const SceneNode& node = scene.nodes[i];
  if (node.parent != no_index && node.parent >= i) return "its parent does not come before it";
  if (node.part != no_index && node.part >= parts) return "its part is not there";
  if ((node.part == no_index) != (node.material == no_index)) return "it has a part without a material";
  if (node.material != no_index && node.material >= scene.materials.size())
    return "its material is not there";
  return is_finite(node.local) ? "" : "its transform is not finite";
}

bool is_unit_interval(float x) {
  return x >= 0 && x <= 1;
}

std::string channel_fault(const Scene& scene, const SceneChannel& c) {
  if (c.node >= scene.nodes.size()) return "its node is not there";
  if (!std::holds_alternative<Trs>(scene.nodes[c.node].local)) return "its node has a matrix";
  if (c.times_s.empty()) return "it has no keys";
  const std::size_t per_key = c.components() * (c.interpolation == Interpolation::cubic ? 3 : 1);
  if (c.values.size() != c.times_s.size() * per_key) return "it has not one value per key";
  const auto finite = [](float x) { return std::isfinite(x); };
  if (!std::all_of(c.times_s.begin(), c.times_s.end(), finite) ||
      !std::all_of(c.values.begin(), c.values.end(), finite))
    return "a number is not finite";
  const auto not_ascending = [](float a, float b) { return !(a < b); };
  return std::adjacent_find(c.times_s.begin(), c.times_s.end(), not_ascending) == c.times_s.end()
             ? ""
             : "its times do not ascend";
}

using Value = std::array<double, 4>;

/// The n-th triple or quaternion of the channel's values.
Value value(const SceneChannel& c, std::size_t n) {
  Value v{};
  const auto values = std::span(c.values).subspan(n * c.components(), c.components());
  std::transform(values.begin(), values.end(), v.begin(), [](float x) { return double{x}; });
  return v;
}

template <class F>
Value each_component(F&& f) {
  return {f(0), f(1), f(2), f(3)};
}

double dot4(const Value& a, const Value& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

/// Along the shorter great arc; nearly equal ones along the chord, which is then the same.
Value slerp(const Value& a, Value b, double t) {
  double cosine = dot4(a, b);
  if (cosine < 0) {
    for (double& x : b) x = -x;
    cosine = -cosine;
  }
  double at_a = 1 - t, at_b = t;
  if (cosine < 0.9995) {
    const double angle = std::acos(cosine);
    at_a = std::sin((1 - t) * angle) / std::sin(angle);
    at_b = std::sin(t * angle) / std::sin(angle);
  }
  return each_component([&](std::size_t k) { return a[k] * at_a + b[k] * at_b; });
}

/// glTF 2.0, appendix C.5; tangents are per second.
Value hermite(const SceneChannel& c, std::size_t key, double seconds, double t) {
  const double t2 = t * t, t3 = t2 * t;
  const Value a = value(c, 3 * key + 1), leaving = value(c, 3 * key + 2);
  const Value arriving = value(c, 3 * key + 3), b = value(c, 3 * key + 4);
  return each_component([&](std::size_t k) {
    return (2 * t3 - 3 * t2 + 1) * a[k] + seconds * (t3 - 2 * t2 + t) * leaving[k] +
           (3 * t2 - 2 * t3) * b[k] + seconds * (t3 - t2) * arriving[k];
  });
}

Value between(const SceneChannel& c, std::size_t key, double at) {
  const double first = double{c.times_s[key]}, span = double{c.times_s[key + 1]} - first;
  const double t = (at - first) / span;
  switch (c.interpolation) {
    case Interpolation::step:
      return value(c, key);
    case Interpolation::cubic:
      return hermite(c, key, span, t);
    case Interpolation::linear:
      break;
  }
  const Value a = value(c, key), b = value(c, key + 1);
  if (c.property == AnimatedProperty::rotation) return slerp(a, b, t);
  return each_component([&](std::size_t k) { return a[k] + (b[k] - a[k]) * t; });
}

Value at_key(const SceneChannel& c, std::size_t key) {
  return value(c, c.interpolation == Interpolation::cubic ? 3 * key + 1 : key);
}

}  // namespace

Affine affine_of(const Trs& trs) {
  const auto [x, y, z, w] = trs.rotation;
  const Vec3d s = trs.scale;
  return {{Vec3d{(1 - 2 * (y * y + z * z)) * s.x, 2 * (x * y + z * w) * s.x, 2 * (x * z - y * w) * s.x},
           Vec3d{2 * (x * y - z * w) * s.y, (1 - 2 * (x * x + z * z)) * s.y, 2 * (y * z + x * w) * s.y},
           Vec3d{2 * (x * z + y * w) * s.z, 2 * (y * z - x * w) * s.z, (1 - 2 * (x * x + y * y)) * s.z}},
          trs.translation};
}

Affine affine_of(const LocalTransform& local) {
  const Trs* trs = std::get_if<Trs>(&local);
  return trs ? affine_of(*trs) : std::get<Affine>(local);
}

double SceneClip::seconds() const {
  double last = 0;
  for (const SceneChannel& c : channels)
    if (!c.times_s.empty()) last = std::max(last, double{c.times_s.back()});
  return last;
}

std::string fault_of(const Scene& scene, std::uint64_t parts) {
  for (std::size_t i = 0; i < scene.nodes.size(); ++i)
    if (const auto fault = node_fault(scene, i, parts); !fault.empty())
      return fmt::format("node {}: {}", i, fault);
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    if (!is_unit_interval(scene.materials[i].metallic) || !is_unit_interval(scene.materials[i].roughness))
      return fmt::format("material {}: a factor is not in 0 … 1", i);
  for (std::size_t i = 0; i < scene.clips.size(); ++i)
    for (const SceneChannel& c : scene.clips[i].channels)
      if (const auto fault = channel_fault(scene, c); !fault.empty())
        return fmt::format("clip {}, channel {}: {}", i, &c - scene.clips[i].channels.data(), fault);
  return "";
}

std::vector<Affine> world_transforms(const Scene& scene) {
  std::vector<Affine> world;
  world.reserve(scene.nodes.size());
  for (const SceneNode& node : scene.nodes) {
    const Affine local = affine_of(node.local);
    world.push_back(node.parent == no_index ? local : world[node.parent] * local);
  }
  return world;
}

std::array<double, 4> value_at(const SceneChannel& c, double seconds) {
  CUESTA_CHECK(!c.times_s.empty());
  const auto after = std::upper_bound(c.times_s.begin(), c.times_s.end(), seconds,
                                      [](double at, float key) { return at < double{key}; });
  const auto key = static_cast<std::size_t>(after - c.times_s.begin());
  Value v = key == 0                  ? at_key(c, 0)
            : key == c.times_s.size() ? at_key(c, key - 1)
                                      : between(c, key - 1, seconds);
  if (c.property != AnimatedProperty::rotation) return v;
  const double length = std::sqrt(dot4(v, v));
  if (!(length > 0)) return {0, 0, 0, 1};
  return each_component([&](std::size_t k) { return v[k] / length; });
}

void apply_clip(const SceneClip& clip, double seconds, std::vector<LocalTransform>& locals) {
  for (const SceneChannel& c : clip.channels) {
    CUESTA_CHECK(c.node < locals.size(), c.node, locals.size());
    Trs* trs = std::get_if<Trs>(&locals[c.node]);
    CUESTA_CHECK(trs != nullptr, c.node);
    const Value v = value_at(c, seconds);
    if (c.property == AnimatedProperty::rotation)
      trs->rotation = v;
    else
      (c.property == AnimatedProperty::scale ? trs->scale : trs->translation) = {v[0], v[1], v[2]};
  }
}

}  // namespace cuesta
