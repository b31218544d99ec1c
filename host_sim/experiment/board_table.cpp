// The boards, from their folders.
#include "host_sim/experiment/board_table.h"

#include <map>

#include "boards.h"
#include "host_sim/core/errors.h"

namespace screed {

const BoardConstants& board_constants_of(const std::string& name) {
  static const std::map<std::string, const BoardConstants*> boards = {
#define SCREED_BOARD(board) {#board, &kBoard_##board},
      SCREED_BOARDS(SCREED_BOARD)
#undef SCREED_BOARD
  };
  const auto found = boards.find(name);
  if (found != boards.end()) return *found->second;
  std::string known;
  for (const auto& [board, constants] : boards) known += (known.empty() ? "" : ", ") + board;
  throw InputError("board '" + name + "' is not known; there are: " + known);
}

}  // namespace screed
