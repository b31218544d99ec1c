// The last frame of each message.
#include "host_sim/ground_station/telemetry/latest_telemetry.h"

#include <algorithm>
#include <iterator>

#include "firmware/parameters/parameters.h"
#include "firmware/protocol/messages.h"

namespace screed {
namespace {

std::optional<uint16_t> index_of(std::string_view parameter) {
  const auto* const found =
      std::find_if(std::begin(kParameterTable), std::end(kParameterTable),
                   [parameter](const ParameterInfo& info) { return info.name == parameter; });
  if (found == std::end(kParameterTable)) return std::nullopt;
  return static_cast<uint16_t>(found - std::begin(kParameterTable));
}

}  // namespace

std::array<uint8_t, 8> frame_bytes(const CanFrame& frame) {
  std::array<uint8_t, 8> data{};
  std::copy_n(frame.data, std::min<size_t>(frame.size, data.size()), data.begin());
  return data;
}

void LatestTelemetry::add_frame(uint64_t time_us, const CanFrame& frame,
                                const MessageInfo& message) {
  frames_[message.id] = {time_us, frame_bytes(frame)};
  if (message.id != message::ParamValue::kId) return;
  const auto parameter = message::ParamValue::unpack(frame.data);
  parameters_[parameter.index] = parameter.value;
}

const LatestTelemetry::Frame* LatestTelemetry::frame(const MessageInfo& message) const {
  const auto found = frames_.find(message.id);
  return found == frames_.end() ? nullptr : &found->second;
}

std::optional<int64_t> LatestTelemetry::raw(std::string_view path) const {
  const SignalRef place = find_signal(path);
  const Frame* const last = frame(*place.message);
  if (last == nullptr) return std::nullopt;
  return place.signal->raw(last->data.data());
}

std::optional<double> LatestTelemetry::value(std::string_view path) const {
  const std::optional<int64_t> bits = raw(path);
  if (!bits.has_value()) return std::nullopt;
  return find_signal(path).signal->value(*bits);
}

std::string LatestTelemetry::text(std::string_view path) const {
  const std::optional<int64_t> bits = raw(path);
  return bits.has_value() ? display_name(find_signal(path).signal->text(*bits)) : "-";
}

std::optional<double> LatestTelemetry::age_s(const MessageInfo& message, uint64_t now_us) const {
  const Frame* const last = frame(message);
  if (last == nullptr) return std::nullopt;
  return now_us > last->time_us ? static_cast<double>(now_us - last->time_us) * 1e-6 : 0.0;
}

std::optional<int32_t> LatestTelemetry::parameter(std::string_view name) const {
  const std::optional<uint16_t> index = index_of(name);
  const auto found = index.has_value() ? parameters_.find(*index) : parameters_.end();
  if (found == parameters_.end()) return std::nullopt;
  return found->second;
}

void LatestTelemetry::set_parameter(std::string_view name, int32_t value) {
  if (const std::optional<uint16_t> index = index_of(name)) parameters_[*index] = value;
}

}  // namespace screed
