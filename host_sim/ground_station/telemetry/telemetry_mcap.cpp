// Messages of the radio in MCAP files.
#include "host_sim/ground_station/telemetry/telemetry_mcap.h"

#include <string>

#include "host_sim/core/json.h"

namespace screed {
namespace {

std::string json_schema(const MessageInfo& message) {
  Json properties = Json::object();
  for (const SignalInfo& signal : message.signals) {
    if (signal.role != SignalRole::kData) continue;
    Json property;
    property["type"] = signal.flags[0] != '\0' ? "boolean"
                       : signal.values.empty() ? "number"
                                               : "string";
    std::string description = signal.unit;
    if (signal.comment[0] != '\0') {
      description += (description.empty() ? "" : "; ") + std::string(signal.comment);
    }
    if (!description.empty()) property["description"] = description;
    properties[signal.name] = property;
  }
  return Json{{"title", std::string("screed.") + message.title},
              {"description", message.comment},
              {"type", "object"},
              {"properties", properties}}
      .dump();
}

std::string json_of(const DecodedFrame& frame) {
  std::string text = "{";
  for (const SignalInfo& signal : frame.message->signals) {
    if (signal.role != SignalRole::kData) continue;
    const int64_t raw = signal.raw(frame.bits);
    if (text.size() > 1) text += ',';
    text += '"';
    text += signal.name;
    text += "\":";
    if (signal.flags[0] != '\0') {
      text += raw != 0 ? "true" : "false";
    } else if (signal.values.empty()) {
      text += signal.text(raw);
    } else {
      text += '"';
      text += signal.text(raw);
      text += '"';
    }
  }
  return text + "}";
}

}  // namespace

McapFile::Id TelemetryMcap::channel_of(const DecodedFrame& frame) {
  const MessageInfo& message = *frame.message;
  McapFile::Id& channel = channels_[{&message, frame.node}];
  if (channel == 0) {
    McapFile::Id& schema = schemas_[&message];
    if (schema == 0) {
      schema = file_.add_schema(std::string("screed.") + message.title, "jsonschema",
                                json_schema(message));
    }
    const std::string of =
        frame.node == 0 ? std::string("ground") : "robot" + std::to_string(frame.node);
    channel = file_.add_channel("/" + of + "/" + message.title, "json", schema);
  }
  return channel;
}

void TelemetryMcap::add(const DecodedFrame& frame) {
  const McapFile::Id channel = channel_of(frame);
  file_.add_message(channel, frame.time_us * 1000U, json_of(frame));
}

}  // namespace screed
