// `screed decode`.
#include "tools/screed/link/decode_command.h"

#include <filesystem>
#include <iostream>

#include "host_sim/core/errors.h"
#include "host_sim/ground_station/telemetry/candump_log.h"
#include "host_sim/ground_station/telemetry/csv_tables.h"
#include "host_sim/ground_station/telemetry/telemetry_mcap.h"
#include "tools/screed/cli/command.h"

namespace screed {
namespace {

std::string beside_log(const DecodeOptions& options) {
  if (options.log == "-") throw InputError("--out: is needed when the log is standard input");
  std::filesystem::path path(options.log);
  if (options.mcap) return path.replace_extension(".mcap").string();
  return path.replace_extension().string() + "_csv";
}

}  // namespace

int run_decode(const DecodeOptions& options, std::ostream& out, std::ostream& err) {
  if (options.csv == options.mcap) throw InputError("decode: one of --csv and --mcap is needed");
  const std::string target = options.out.empty() ? beside_log(options) : options.out;
  LogDecoder decoder(options.log);
  DecodedFrame frame;
  bool more = decoder.next(frame);
  if (!more) decoder.expect_messages();  // before anything is made
  if (options.csv) {
    const BoardConstants& board = board_constants_of(options.board);
    CsvTables tables(target, options.numbers);
    TrackSlipTable slip(target, board);
    for (; more; more = decoder.next(frame)) {
      tables.add(frame);
      slip.add(frame);
    }
    for (const std::string& name : tables.finish()) out << name << "\n";
    if (const auto name = slip.finish(); name.has_value()) out << *name << "\n";
  } else {
    TelemetryMcap file(target);
    for (; more; more = decoder.next(frame)) file.add(frame);
    file.finish();
    out << target << "\n";
  }
  err << options.log << ": " << decoder.statistics().text() << "\n";
  return decoder.statistics().damaged() > 0 ? 1 : 0;
}

void register_decode_command(Command& root, Program& program) {
  auto [command, options] = add_subcommand<DecodeOptions>(
      root, program, "decode", "Convert a radio log to CSV tables or to an MCAP file for Foxglove",
      [](const DecodeOptions& given) { return run_decode(given, std::cout, std::cerr); });
  command.add_option("LOG", options.log, "Log as written by candump -L; -: standard input")
      ->required();
  command.add_flag(
      "--csv", options.csv,
      "Write a folder of CSV tables, one per message, and one of the slip of both tracks");
  command.add_flag("--mcap", options.mcap, "Write an MCAP file");
  command
      .add_option("--out", options.out,
                  "Output path (default: LOG without its extension, with _csv or .mcap)")
      ->type_name("PATH");
  command.add_flag("--numbers", options.numbers, "Write named values as numbers (CSV)");
  command.add_option("--board", options.board, "Board of the robots (CSV)")
      ->type_name("NAME")
      ->show_default();
}

}  // namespace screed
