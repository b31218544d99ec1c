// The schema compiler: any text is refused with a line number, or compiled.
#include <cstdint>
#include <string>

#include "host_sim/core/errors.h"
#include "tests/fuzz/require.h"
#include "tools/schema/code.h"
#include "tools/schema/dbc.h"
#include "tools/schema/documentation.h"
#include "tools/schema/schema_check.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  const std::string text(reinterpret_cast<const char*>(bytes), size);
  try {
    const screed::schema::Database database = screed::schema::parse_dbc("it.dbc", text);
    screed::schema::check_schema(database);
    SCREED_REQUIRE(!screed::schema::message_code(database).empty());
    SCREED_REQUIRE(!screed::schema::host_tables(database).empty());
    SCREED_REQUIRE(screed::schema::wireshark_tables(database).size() == 5);
  } catch (const screed::InputError& error) {
    SCREED_REQUIRE(std::string(error.what()).starts_with("it.dbc:"));
  }
  return 0;
}
