// One port, several programs. Here they are objects of one process: the socket does not mind.
#include "host_sim/ground_station/link/shared_link.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "firmware/protocol/messages.h"
#include "host_sim/core/errors.h"

namespace screed {
namespace {

using std::chrono::milliseconds;

/// What goes over the port, whoever holds it.
struct Wire {
  std::mutex mutex;
  std::vector<LinkFrame> arriving;
  std::vector<CanFrame> sent;
  int opened = 0;
};

class FakePort : public Link {
 public:
  explicit FakePort(Wire& wire) : wire_(wire) {
    const std::lock_guard lock(wire.mutex);
    ++wire.opened;
    status_.up = true;
    status_.text = "up";
  }
  void receive(milliseconds /*wait*/, std::vector<LinkFrame>& frames) override {
    const std::lock_guard lock(wire_.mutex);
    frames.insert(frames.end(), wire_.arriving.begin(), wire_.arriving.end());
    wire_.arriving.clear();
  }
  bool send(const CanFrame& frame) override {
    const std::lock_guard lock(wire_.mutex);
    wire_.sent.push_back(frame);
    return true;
  }
  const LinkStatus& status() const override { return status_; }
  const std::string& name() const override { return name_; }

 private:
  Wire& wire_;
  LinkStatus status_;
  std::string name_ = "fake";
};

/// A program that holds the port and does nothing but serve it.
class Owner {
 public:
  Owner(const std::string& device, Wire& wire)
      : link_(std::make_unique<SharedLink>(device,
                                           [&wire] { return std::make_unique<FakePort>(wire); })),
        thread_([this] {
          std::vector<LinkFrame> frames;
          while (!stop_) link_->receive(milliseconds(1), frames);
          link_.reset();
        }) {}
  ~Owner() { end(); }
  void end() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }

 private:
  std::atomic<bool> stop_ = false;
  std::unique_ptr<SharedLink> link_;
  std::thread thread_;
};

CanFrame frame_with(uint16_t id, uint8_t first) {
  CanFrame frame{};
  frame.id = id;
  frame.size = 8;
  frame.data[0] = first;
  return frame;
}

class SharedLinkTest : public ::testing::Test {
 protected:
  std::unique_ptr<SharedLink> guest() {
    auto link =
        std::make_unique<SharedLink>(device_, [this] { return std::make_unique<FakePort>(wire_); });
    EXPECT_FALSE(link->owns());
    return link;
  }
  /// Until the wire has taken so many frames.
  void wait_for_sent(size_t count) {
    for (;;) {
      const std::lock_guard lock(wire_.mutex);
      if (wire_.sent.size() >= count) return;
    }
  }

  Wire wire_;
  const std::string device_ = std::string("/no/such/port/") +
                              ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(SharedLinkTest, TheSecondHearsWhatTheFirstHears) {
  Owner owner(device_, wire_);
  const auto second = guest();
  EXPECT_TRUE(second->status().up);
  {
    const std::lock_guard lock(wire_.mutex);
    wire_.arriving.push_back({1234, frame_with(0x210, 7), RadioSource{0x13A2, -60}});
  }
  std::vector<LinkFrame> frames;
  while (frames.empty()) second->receive(milliseconds(100), frames);
  EXPECT_EQ(frames[0].time_us, 1234U);
  EXPECT_EQ(frames[0].frame.id, 0x210);
  EXPECT_EQ(frames[0].frame.data[0], 7);
  EXPECT_EQ(frames[0].source->address, 0x13A2U);
  EXPECT_EQ(frames[0].source->rssi_dbm, -60);
  EXPECT_EQ(wire_.opened, 1);
}

TEST_F(SharedLinkTest, EverybodyMaySendAndOneIsTheGroundStation) {
  Owner owner(device_, wire_);
  const auto second = guest();
  const auto third = guest();
  EXPECT_TRUE(second->send(frame_with(kIdGroundHeartbeat, 2)));
  wait_for_sent(1);
  EXPECT_TRUE(third->send(frame_with(kIdGroundHeartbeat, 3)));
  EXPECT_TRUE(third->send(frame_with(kIdCommand, 4)));
  wait_for_sent(2);
  EXPECT_EQ(wire_.sent[0].data[0], 2);
  EXPECT_EQ(wire_.sent[1].data[0], 4) << "the heartbeat of the third is dropped";
}

// Both are signed with one number: the robot would take the second for a forged one.
TEST_F(SharedLinkTest, ACommandPassesWhenThatOfAnotherIsAnswered) {
  Owner owner(device_, wire_);
  const auto second = guest();
  const auto third = guest();
  EXPECT_TRUE(second->send(frame_with(kIdCommand, 1)));
  wait_for_sent(1);
  EXPECT_TRUE(third->send(frame_with(kIdCommand, 2)));
  EXPECT_TRUE(third->send(frame_with(kIdParamStage, 3)));
  wait_for_sent(2);
  EXPECT_TRUE(second->send(frame_with(kIdCommand, 1)));
  wait_for_sent(3);
  {
    const std::lock_guard lock(wire_.mutex);
    wire_.arriving.push_back({1234, frame_with(kIdCommandAck, 1), std::nullopt});
  }
  std::vector<LinkFrame> frames;
  while (frames.empty()) third->receive(milliseconds(100), frames);
  EXPECT_TRUE(third->send(frame_with(kIdCommand, 2)));
  wait_for_sent(4);
  const int expected[] = {1, 3, 1, 2};
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(wire_.sent[i].data[0], expected[i]) << i;
}

TEST_F(SharedLinkTest, WhenTheOwnerEndsAnotherTakesItsPlace) {
  auto owner = std::make_unique<Owner>(device_, wire_);
  const auto second = guest();
  owner->end();
  std::vector<LinkFrame> frames;
  while (!second->owns()) second->receive(milliseconds(10), frames);
  EXPECT_EQ(wire_.opened, 2);
  EXPECT_TRUE(second->send(frame_with(kIdCommand, 5)));
  EXPECT_EQ(wire_.sent.back().data[0], 5);
}

TEST_F(SharedLinkTest, APortThatCannotBeOpenedIsNobodys) {
  const auto none = []() -> std::unique_ptr<Link> { throw InputError("no such port"); };
  EXPECT_THROW(SharedLink(device_, none), InputError);
  SharedLink link(device_, [this] { return std::make_unique<FakePort>(wire_); });
  EXPECT_TRUE(link.owns());
}

}  // namespace
}  // namespace screed
