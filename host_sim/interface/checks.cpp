// Messages of refused arguments.
#include "host_sim/interface/checks.h"

#include <sstream>

namespace screed::interface {

void require(bool allowed, const std::string& what, double value, const char* range) {
  if (allowed) return;
  std::ostringstream text;
  text << what << " = " << value << "; allowed: " << range;
  throw InputError(text.str());
}

void require_pointer(const void* pointer, const char* what) {
  if (pointer == nullptr) throw InputError(std::string(what) + ": a null pointer");
}

void copy_heights(const HeightField& field, const screed_rectangle* part, double* heights) {
  require_pointer(part, "part");
  require_pointer(heights, "heights");
  const auto within = [](int first, int count, int all) {
    return first >= 0 && count >= 0 && first <= all && count <= all - first;
  };
  if (!within(part->x, part->nodes_x, field.nx()) || !within(part->y, part->nodes_y, field.ny())) {
    throw InputError("part: beyond the bed; allowed: within 0 to " + std::to_string(field.nx()) +
                     " and 0 to " + std::to_string(field.ny()) + " nodes");
  }
  for (int iy = part->y; iy < part->y + part->nodes_y; ++iy) {
    for (int ix = part->x; ix < part->x + part->nodes_x; ++ix)
      *heights++ = field.node(ix, iy) * kHeightUnit_m;
  }
}

}  // namespace screed::interface
