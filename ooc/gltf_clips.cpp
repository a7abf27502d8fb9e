#include "ooc/gltf_clips.h"

#include <cmath>

#include "ooc/gltf_data.h"

namespace cuesta::gltf {
namespace {

/// What of a key's values there is to keep.
struct KeyShape {
  std::uint32_t components;
  std::uint64_t elements;  ///< of the accessor, per key
};

bool is_finite(const Numbers& values, std::uint64_t first, const KeyShape& shape) {
  for (std::uint64_t e = first; e < first + shape.elements; ++e)
    for (std::uint32_t k = 0; k < shape.components; ++k)
      if (!std::isfinite(values.real(e, k))) return false;
  return true;
}

void append(const Numbers& values, std::uint64_t first, const KeyShape& shape, std::vector<float>& out) {
  for (std::uint64_t e = first; e < first + shape.elements; ++e)
    for (std::uint32_t k = 0; k < shape.components; ++k) out.push_back(static_cast<float>(values.real(e, k)));
}

Result<SceneChannel> read_channel(const ReadJob& job, const Channel& from, Data& data, ClipReport& report) {
  const auto times = data.numbers(from.sampler.times);
  if (!times) return fail(times.error());
  const auto values = data.numbers(from.sampler.values);
  if (!values) return fail(values.error());
  SceneChannel channel;
  channel.property = from.property;
  channel.interpolation = from.sampler.interpolation;
  const KeyShape shape{static_cast<std::uint32_t>(channel.components()),
                       from.sampler.interpolation == Interpolation::cubic ? 3u : 1u};
  const std::uint64_t keys = times->count;
  if (times->components != 1 || values->components != shape.components ||
      values->count / shape.elements < keys)
    return channel;  // without keys
  CUESTA_TRY(job.budget.charge(keys * (1 + shape.components * shape.elements), 2 * sizeof(float), "keys"));
  for (std::uint64_t key = 0; key < keys; ++key) {
    const auto at = static_cast<float>(times->real(key, 0));
    const bool is_later = channel.times_s.empty() || at > channel.times_s.back();
    if (!std::isfinite(at) || !is_later || !is_finite(*values, key * shape.elements, shape)) {
      ++report.keys_dropped;
      continue;
    }
    channel.times_s.push_back(at);
    append(*values, key * shape.elements, shape, channel.values);
  }
  return channel;
}

}  // namespace

Result<SceneClip> read_clip(const ReadJob& job, const Animation& animation, Data& data,
                            std::span<const std::uint32_t> node_of, const Scene& scene, ClipReport& report) {
  SceneClip clip{animation.name, {}};
  report.channels_dropped += animation.dropped;
  for (const Channel& from : animation.channels) {
    auto channel = read_channel(job, from, data, report);
    if (!channel) return fail(std::move(channel).error());
    channel->node = node_of[from.node];
    const bool is_kept = channel->node != no_index && !channel->times_s.empty() &&
                         std::holds_alternative<Trs>(scene.nodes[channel->node].local);
    if (is_kept)
      clip.channels.push_back(std::move(*channel));
    else
      ++report.channels_dropped;
  }
  return clip;
}

}  // namespace cuesta::gltf
