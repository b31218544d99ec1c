// The C interface of deformable soil: what comes from C is checked here, once; what is thrown ends
// here.
#include "host_sim/interface/screed/soil.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <cereal/archives/portable_binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/vector.hpp>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <deque>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/terrain/footprint.h"
#include "host_sim/physics/terrain/height_field.h"
#include "version.h"

namespace {

using namespace screed;  // of a file whose own names are C's

struct Body {
  std::vector<screed_patch> patches;
  std::vector<Footprint> footprints;
  std::vector<ContactMemory> memories;
  std::vector<FootprintContact> contacts;
  BodyMemory memory;
};

/// Two threads on one soil.
class Busy : public std::runtime_error {
 public:
  Busy() : std::runtime_error("this soil is in use on another thread; one thread at a time") {}
};

}  // namespace

struct screed_soil {
  SoilBed bed;
  std::deque<Body> bodies;     // footprints are known by their address
  bool in_step = false;        // bodies have pressed and the step has not ended
  std::vector<uint32_t> seen;  // revisions of the surface's tiles when changes were last asked for
  mutable std::atomic_flag in_use = ATOMIC_FLAG_INIT;
};

namespace {

class Use {
 public:
  explicit Use(const screed_soil* soil) : soil_(soil) {
    if (soil == nullptr) throw InputError("soil: a null pointer");
    if (soil->in_use.test_and_set(std::memory_order_acquire)) throw Busy();
  }
  ~Use() { soil_->in_use.clear(std::memory_order_release); }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;

 private:
  const screed_soil* soil_;
};

void say(screed_error* error, const char* text) {
  if (error != nullptr) std::snprintf(error->text, sizeof(error->text), "%s", text);
}

/// Does the work; whatever it throws becomes a status and a text.
template <typename Work>
screed_status attempt(screed_error* error, const Work& work) noexcept {
  say(error, "");
  try {
    work();
    return SCREED_OK;
  } catch (const Busy& busy) {
    say(error, busy.what());
    return SCREED_BUSY;
  } catch (const InputError& wrong) {
    say(error, wrong.what());
    return SCREED_BAD_INPUT;
  } catch (const std::bad_alloc&) {
    say(error, "not enough memory");
    return SCREED_NO_MEMORY;
  } catch (const std::exception& failed) {
    say(error, failed.what());
    return SCREED_FAILED;
  }
}

// ---- what comes from C, checked
// --------------------------------------------------------------------------------------

std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

void require(bool allowed, const std::string& what, double value, const char* range) {
  if (!allowed) throw InputError(what + " = " + number(value) + "; allowed: " + range);
}

void require_pointer(const void* pointer, const char* what) {
  if (pointer == nullptr) throw InputError(std::string(what) + ": a null pointer");
}

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Eigen::Vector3d vector_from(const double* from, const char* what) {
  Eigen::Vector3d vector = Eigen::Map<const Eigen::Vector3d>(from);
  for (const double part : vector) require(std::isfinite(part), what, part, "finite numbers");
  return vector;
}

Eigen::Matrix3d matrix_from(const double* from, const char* what) {
  Eigen::Matrix3d matrix = Eigen::Map<const RowMajor>(from);
  for (const double part : matrix.reshaped())
    require(std::isfinite(part), what, part, "finite numbers");
  return matrix;
}

Eigen::Matrix3d rotation_from(const double* from) {
  constexpr double kError = 1e-6;
  Eigen::Matrix3d axes = matrix_from(from, "axes");
  const double error =
      (axes.transpose() * axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  require(error < kError && axes.determinant() > 0.0, "axes: error of the rotation", error,
          "below 1e-6, right-handed");
  return axes;
}

/// Zero stays zero.
Eigen::Matrix3d inverse_inertia_from(const double* from) {
  Eigen::Matrix3d inertia = matrix_from(from, "inertia");
  if (inertia.isZero(0.0)) return inertia;
  const Eigen::LLT<Eigen::Matrix3d> factors(inertia);
  if (factors.info() != Eigen::Success || !inertia.isApprox(inertia.transpose(), 1e-9)) {
    throw InputError("inertia: allowed: a symmetric matrix with positive moments, or all zero");
  }
  return factors.solve(Eigen::Matrix3d::Identity());
}

Footprint footprint_of(const screed_patch& patch) {
  const auto need = [&](int sizes) {
    for (int i = 0; i < sizes; ++i) {
      require(patch.size[i] >= 1e-4 && patch.size[i] <= 100.0, "size", patch.size[i],
              "0.0001 to 100 m");
    }
  };
  require(patch.friction >= 0.0, "friction", patch.friction, "0 or more");
  require(patch.adhesion >= 0.0 && patch.adhesion <= 1e6, "adhesion", patch.adhesion,
          "0 to 1000000 Pa");
  require(patch.lug_height >= 0.0 && patch.lug_height <= 0.1, "lug_height", patch.lug_height,
          "0 to 0.1 m");
  const double* size = patch.size;
  switch (patch.shape) {
    case SCREED_WHEEL:
      need(2);
      return Footprint::wheel(size[0], size[1]);
    case SCREED_TRACK:
      need(3);
      return Footprint::track(0.5 * size[2], size[0], size[1]);
    case SCREED_BOX:
      need(3);
      return Footprint::box(vector_from(size, "size"));
    case SCREED_DISC:
      need(2);
      return Footprint::disc(size[0], size[1]);
  }
  throw InputError("shape = " + std::to_string(patch.shape) + "; allowed: 0 to 3 (screed_shape)");
}

void add_body(screed_soil& soil, std::vector<screed_patch> patches) {
  Body body;
  for (const screed_patch& patch : patches) body.footprints.push_back(footprint_of(patch));
  body.memories.resize(patches.size());
  body.contacts.resize(patches.size());
  for (size_t i = 0; i < patches.size(); ++i) {
    FootprintMotion motion;
    motion.soil_friction = patches[i].friction;
    motion.adhesion_pa = patches[i].adhesion;
    motion.lug_height_m = patches[i].lug_height;
    body.contacts[i] = {&body.footprints[i], &body.memories[i], motion};
  }
  body.patches = std::move(patches);
  soil.bodies.push_back(std::move(body));  // a vector that moves keeps its elements' addresses
}

// ---- making a bed
// ----------------------------------------------------------------------------------------------------

struct Model {  // of soil and of how it is computed
  SoilParameters soil;
  SoilOptions options;
};

void apply(const screed_setting& setting, Model& model) {
  require_pointer(setting.key, "setting: key");
  const auto is_switch = [&] {
    require(setting.value == 0.0 || setting.value == 1.0, setting.key, setting.value, "0 or 1");
    return setting.value == 1.0;
  };
  const std::string key = setting.key;
  if (key == "bulldozing") {
    model.options.bulldozing = is_switch();
  } else if (key == "avalanches") {
    model.options.avalanches = is_switch();
  } else if (key == "vertical_stress") {
    model.options.normal_stress = is_switch() ? NormalStress::kVertical : NormalStress::kRadial;
  } else {
    const auto* row = std::find_if(std::begin(kSoilParameters), std::end(kSoilParameters),
                                   [&](const SoilParameterInfo& it) { return key == it.key; });
    if (row == std::end(kSoilParameters)) {
      throw InputError("no setting '" + key +
                       "'; allowed: bulldozing, avalanches, vertical_stress and what "
                       "screed_soil_key() lists");
    }
    model.soil.*row->member = setting.value;
  }
}

BedEdge edge_of(int edge) {
  if (edge == SCREED_EDGE_OPEN) return BedEdge::kOpen;
  if (edge == SCREED_EDGE_WRAPPED) return BedEdge::kWrapped;
  if (edge == SCREED_EDGE_WALLED) return BedEdge::kWalled;
  throw InputError("edge = " + std::to_string(edge) + "; allowed: 0 to 2 (screed_edge)");
}

HeightField field_of(const screed_bed& bed) {
  const BedEdge edge = edge_of(bed.edge);
  HeightField field(bed.nodes_x, bed.nodes_y, bed.spacing, edge == BedEdge::kWrapped);
  if (edge == BedEdge::kWalled) field.add_walls();
  if (bed.heights == nullptr) return field;
  const double* height = bed.heights;
  for (int iy = 0; iy < bed.nodes_y; ++iy) {
    for (int ix = 0; ix < bed.nodes_x; ++ix, ++height) {
      require(std::abs(*height) <= 127.0, "height", *height, "-127 to 127 m");
      field.set_node(ix, iy, static_cast<Height>(std::lround(*height / kHeightUnit_m)));
    }
  }
  field.refresh_bounds();
  return field;
}

screed_soil* make_soil(HeightField field, Model model) {
  check_soil(model.soil);
  return new screed_soil{SoilBed(std::move(field), model.soil, model.options), {}, false, {}};
}

// ---- a state as bytes
// ------------------------------------------------------------------------------------------------

/// Both ways: what serialize() of the bed and its bodies does not hold, since it makes them.
struct Making {
  int32_t nodes_x = 0;
  int32_t nodes_y = 0;
  double spacing_m = 0.0;
  int32_t edge = 0;
  std::vector<Height> heights;
  Model model;
  std::vector<std::vector<screed_patch>> bodies;

  template <typename Archive>
  void serialize(Archive& archive) {
    archive(nodes_x, nodes_y, spacing_m, edge, heights, model.soil.name);
    for (const SoilParameterInfo& it : kSoilParameters) archive(model.soil.*it.member);
    SoilOptions& options = model.options;
    archive(options.normal_stress, options.bulldozing, options.avalanches, options.follow_slopes,
            options.sample_spacing_m, bodies);
  }
};

uint64_t checksum(std::string_view bytes) {  // FNV-1a
  uint64_t sum = 0xCBF29CE484222325U;
  for (const char byte : bytes) sum = (sum ^ static_cast<uint8_t>(byte)) * 0x100000001B3U;
  return sum;
}

Making making_of(const screed_soil& soil) {
  const HeightField& field = soil.bed.surface();
  Making making;
  making.nodes_x = field.nx();
  making.nodes_y = field.ny();
  making.spacing_m = field.spacing_m();
  making.edge = field.wrap()                       ? SCREED_EDGE_WRAPPED
                : field.edge() == BedEdge::kWalled ? SCREED_EDGE_WALLED
                                                   : SCREED_EDGE_OPEN;
  making.heights.assign(field.heights(),
                        field.heights() + static_cast<size_t>(field.nx()) * field.ny());
  making.model = {soil.bed.soil(), soil.bed.options()};
  for (const Body& body : soil.bodies) making.bodies.push_back(body.patches);
  return making;
}

template <typename Archive>
void serialize_rest(Archive& archive, screed_soil& soil) {
  archive(soil.bed);
  for (Body& body : soil.bodies) {
    archive(body.memory);
    for (ContactMemory& memory : body.memories) archive(memory);
  }
}

/// What stands before the rest of a state.
struct Head {
  std::array<char, 12> name = {'s', 'c', 'r', 'e', 'e', 'd', ' ', 's', 'o', 'i', 'l', '\n'};
  uint32_t version = 1;
  uint64_t sum = 0;  // of the rest

  template <typename Archive>
  void serialize(Archive& archive) {
    archive(name, version, sum);
  }
};

std::string state_of(const screed_soil& soil) {
  std::ostringstream rest;
  {
    cereal::PortableBinaryOutputArchive archive(rest);
    archive(making_of(soil));
    serialize_rest(archive, const_cast<screed_soil&>(soil));  // an archive that writes only reads
  }
  std::ostringstream head;
  cereal::PortableBinaryOutputArchive{head}(Head{.sum = checksum(rest.view())});
  return head.str() + rest.str();
}

screed_soil* soil_from(std::string_view state) {
  constexpr size_t kHeadBytes = 1 + 12 + 4 + 8;  // the first says the order of bytes
  const InputError damaged("state: damaged, or not one of this library");
  if (state.size() <= kHeadBytes) throw damaged;
  Head head;
  std::istringstream head_bytes(std::string(state.substr(0, kHeadBytes)));
  cereal::PortableBinaryInputArchive{head_bytes}(head);
  const std::string_view rest = state.substr(kHeadBytes);
  if (head.name != Head().name || head.sum != checksum(rest)) throw damaged;
  if (head.version != Head().version) {
    throw InputError("state of version " + std::to_string(head.version) +
                     "; allowed: " + std::to_string(Head().version));
  }
  std::istringstream bytes{std::string(rest)};
  cereal::PortableBinaryInputArchive archive(bytes);
  Making making;
  archive(making);
  HeightField field(making.nodes_x, making.nodes_y, making.spacing_m,
                    making.edge == SCREED_EDGE_WRAPPED);
  if (making.edge == SCREED_EDGE_WALLED) field.add_walls();
  for (int node = 0; node < making.nodes_x * making.nodes_y; ++node) {
    field.set_node(node % making.nodes_x, node / making.nodes_x,
                   making.heights.at(static_cast<size_t>(node)));
  }
  field.refresh_bounds();
  std::unique_ptr<screed_soil> soil(make_soil(std::move(field), making.model));
  for (std::vector<screed_patch>& patches : making.bodies) add_body(*soil, std::move(patches));
  serialize_rest(archive, *soil);
  return soil.release();
}

}  // namespace

template <typename Archive>
void serialize(Archive& archive, screed_patch& patch) {
  archive(patch.shape, patch.size, patch.friction, patch.adhesion, patch.lug_height);
}

// ---- the interface
// ---------------------------------------------------------------------------------------------------

const char* screed_soil_version() {
  return SCREED_VERSION;
}

screed_soil* screed_soil_create(const screed_bed* bed, const char* preset,
                                const screed_setting* settings, size_t count, screed_error* error) {
  screed_soil* soil = nullptr;
  attempt(error, [&] {
    require_pointer(bed, "bed");
    require_pointer(preset, "preset");
    if (count > 0) require_pointer(settings, "settings");
    Model model{soil_preset(preset), {}};
    for (size_t i = 0; i < count; ++i) apply(settings[i], model);
    soil = make_soil(field_of(*bed), std::move(model));
  });
  return soil;
}

void screed_soil_destroy(screed_soil* soil) {
  delete soil;
}

const char* screed_soil_preset(size_t index) {
  return index < soil_presets().size() ? soil_presets()[index].soil.name.c_str() : nullptr;
}

const char* screed_soil_key(size_t index) {
  return index < std::size(kSoilParameters) ? kSoilParameters[index].key : nullptr;
}

screed_status screed_soil_parameter(const screed_soil* soil, const char* key, double* value,
                                    screed_error* error) {
  return attempt(error, [&] {
    const Use use(soil);
    require_pointer(key, "key");
    require_pointer(value, "value");
    for (const SoilParameterInfo& it : kSoilParameters) {
      if (std::strcmp(key, it.key) == 0) {
        *value = soil->bed.soil().*it.member;
        return;
      }
    }
    throw InputError(std::string("no parameter '") + key + "'; screed_soil_key() lists them");
  });
}

int screed_soil_add_body(screed_soil* soil, const screed_patch* patches, size_t count,
                         screed_error* error) {
  constexpr size_t kMaxPatches = 1024;
  int index = -1;
  attempt(error, [&] {
    const Use use(soil);
    require_pointer(patches, "patches");
    require(count >= 1 && count <= kMaxPatches, "count of patches", static_cast<double>(count),
            "1 to 1024");
    add_body(*soil, {patches, patches + count});
    index = static_cast<int>(soil->bodies.size()) - 1;
  });
  return index;
}

screed_status screed_soil_press(screed_soil* soil, int body, const screed_body_motion* motion,
                                const screed_patch_motion* patches, double dt,
                                screed_wrench* wrenches, screed_error* error) {
  return attempt(error, [&] {
    const Use use(soil);
    if (body < 0 || static_cast<size_t>(body) >= soil->bodies.size()) {
      throw InputError("body = " + std::to_string(body) + "; allowed: numbers of bodies, " +
                       std::to_string(soil->bodies.size()) + " were added");
    }
    require_pointer(motion, "motion");
    require_pointer(patches, "patches");
    require_pointer(wrenches, "wrenches");
    require(dt >= 1e-5 && dt <= 0.02, "dt", dt, "0.00001 to 0.02 s");
    require(motion->mass >= 1e-6, "mass", motion->mass, "0.000001 kg and more");
    PressingBody pressing;
    pressing.mass_kg = motion->mass;
    pressing.inverse_inertia = inverse_inertia_from(motion->inertia);
    pressing.centre = vector_from(motion->centre, "centre");
    pressing.velocity = vector_from(motion->velocity, "velocity");
    pressing.omega = vector_from(motion->omega, "omega");
    Body& its = soil->bodies[static_cast<size_t>(body)];
    std::vector<Eigen::Isometry3d> poses(its.footprints.size(), Eigen::Isometry3d::Identity());
    for (size_t i = 0; i < poses.size(); ++i) {
      poses[i].linear() = rotation_from(patches[i].axes);
      poses[i].translation() = vector_from(patches[i].position, "position");
      require(std::isfinite(patches[i].surface_speed), "surface_speed", patches[i].surface_speed,
              "finite numbers");
    }
    for (size_t i = 0; i < poses.size(); ++i) {
      its.footprints[i].set_pose(poses[i]);
      FootprintMotion& its_motion = its.contacts[i].motion;
      its_motion.velocity =
          pressing.velocity + pressing.omega.cross(poses[i].translation() - pressing.centre);
      its_motion.omega = pressing.omega;
      its_motion.surface_speed = patches[i].surface_speed;
      its_motion.slip =
          signed_slip(its_motion.surface_speed, its_motion.velocity.dot(poses[i].linear().col(0)));
      its.contacts[i].reaction = {};
    }
    soil->bed.press(pressing, its.contacts, dt, its.memory);
    soil->in_step = true;
    for (size_t i = 0; i < poses.size(); ++i) {
      const TerrainReaction& reaction = its.contacts[i].reaction;
      screed_wrench& wrench = wrenches[i];
      std::copy_n(reaction.force.data(), 3, wrench.force);
      std::copy_n(reaction.torque.data(), 3, wrench.torque);
      wrench.along_surface = reaction.along_surface;
      wrench.load = reaction.normal_load;
      wrench.sinkage = reaction.sinkage;
      wrench.area = reaction.area;
    }
  });
}

screed_status screed_soil_end_step(screed_soil* soil, screed_error* error) {
  return attempt(error, [&] {
    const Use use(soil);
    soil->bed.end_step();
    soil->in_step = false;
  });
}

double screed_soil_height(const screed_soil* soil, double x, double y) {
  return soil == nullptr ? std::nan("") : soil->bed.surface().at(x, y).height;
}

screed_status screed_soil_heights(const screed_soil* soil, const screed_rectangle* part,
                                  double* heights, screed_error* error) {
  return attempt(error, [&] {
    const Use use(soil);
    require_pointer(part, "part");
    require_pointer(heights, "heights");
    const HeightField& field = soil->bed.surface();
    const auto within = [](int first, int count, int all) {
      return first >= 0 && count >= 0 && first <= all && count <= all - first;
    };
    if (!within(part->x, part->nodes_x, field.nx()) ||
        !within(part->y, part->nodes_y, field.ny())) {
      throw InputError("part: beyond the bed; allowed: within 0 to " + std::to_string(field.nx()) +
                       " and 0 to " + std::to_string(field.ny()) + " nodes");
    }
    for (int iy = part->y; iy < part->y + part->nodes_y; ++iy) {
      for (int ix = part->x; ix < part->x + part->nodes_x; ++ix)
        *heights++ = field.node(ix, iy) * kHeightUnit_m;
    }
  });
}

screed_status screed_soil_changed(screed_soil* soil, screed_rectangle* changed,
                                  screed_error* error) {
  return attempt(error, [&] {
    const Use use(soil);
    require_pointer(changed, "changed");
    const HeightField& field = soil->bed.surface();
    const std::vector<uint32_t>& now = field.tile_revisions();
    const bool first = soil->seen.empty();
    Eigen::AlignedBox2i box;
    for (size_t tile = 0; tile < now.size(); ++tile) {
      if (!first && now[tile] == soil->seen[tile]) continue;
      const auto column = static_cast<int>(tile) % field.tiles_x();
      const auto row = static_cast<int>(tile) / field.tiles_x();
      box.extend(Eigen::Vector2i(column, row) * HeightField::kTileNodes);
      box.extend(Eigen::Vector2i(column + 1, row + 1) * HeightField::kTileNodes);
    }
    soil->seen = now;
    *changed = {};
    if (box.isEmpty()) return;
    const Eigen::Vector2i end = box.max().cwiseMin(Eigen::Vector2i(field.nx(), field.ny()));
    *changed = {box.min().x(), box.min().y(), end.x() - box.min().x(), end.y() - box.min().y()};
  });
}

screed_status screed_soil_volumes(const screed_soil* soil, screed_volumes* volumes,
                                  screed_error* error) {
  return attempt(error, [&] {
    const Use use(soil);
    require_pointer(volumes, "volumes");
    const VolumeBalance balance = soil->bed.balance();
    const double spacing = soil->bed.surface().spacing_m();
    *volumes = {balance.before, balance.now, balance.compacted, balance.in_transit,
                kHeightUnit_m * spacing * spacing};
  });
}

size_t screed_soil_save(const screed_soil* soil, void* state, size_t room, screed_error* error) {
  size_t size = 0;
  attempt(error, [&] {
    const Use use(soil);
    if (soil->in_step) throw InputError("save: in the middle of a step; allowed: after its end");
    const std::string bytes = state_of(*soil);
    if (bytes.size() <= room) {
      require_pointer(state, "state");
      std::memcpy(state, bytes.data(), bytes.size());
    }
    size = bytes.size();
  });
  return size;
}

screed_soil* screed_soil_load(const void* state, size_t size, screed_error* error) {
  screed_soil* soil = nullptr;
  attempt(error, [&] {
    require_pointer(state, "state");
    soil = soil_from({static_cast<const char*>(state), size});
  });
  return soil;
}
