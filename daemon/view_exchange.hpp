// Frames to be understood, between the tracking thread and the understanding thread: a fixed pool of slots, handed over
// by index. The tracking thread never waits; its slots have their buffers, so it does not allocate either.
#pragma once

#include <vector>

#include "pipeline/base/spsc_ring.hpp"
#include "pipeline/geometry/camera.hpp"
#include "pipeline/objects/view.hpp"

namespace povslam {

class ViewExchange {
 public:
  // bell: rung with each view. num_landmarks: of a view, room for.
  ViewExchange(int num_slots, const PinholeCamera& camera, std::size_t num_landmarks, Doorbell* bell)
      : slots_(static_cast<std::size_t>(num_slots)),
        filled_(slots_.size(), bell),
        empty_(slots_.size()),
        camera_(camera),
        num_landmarks_(num_landmarks) {
    for (int slot = 0; slot < num_slots; ++slot) {
      make_room(slots_[static_cast<std::size_t>(slot)]);
      empty_.try_push(int{slot});
    }
  }

  // Tracking thread. A view to write into, to be submitted; null: all are in use, this frame is not understood.
  View* draft() {
    if (draft_ < 0) draft_ = empty_.try_pop().value_or(-1);
    return draft_ < 0 ? nullptr : &slots_[static_cast<std::size_t>(draft_)];
  }
  void submit() {
    EXPECTS(draft_ >= 0);
    filled_.try_push(int{draft_});
    draft_ = -1;
  }

  // Understanding thread. The oldest view, or null; give it back, with whatever buffers, before the next one.
  View* try_take() {
    const std::optional<int> slot = filled_.try_pop();
    if (!slot) return nullptr;
    taken_ = *slot;
    return &slots_[static_cast<std::size_t>(taken_)];
  }
  void give_back() {
    make_room(slots_[static_cast<std::size_t>(taken_)]);
    empty_.try_push(int{taken_});
  }

  // Any thread. No more views will come; those inside can still be taken.
  void close() { filled_.close(); }
  bool closed() const { return filled_.closed(); }

 private:
  // Nothing for buffers that are there already.
  void make_room(View& view) const {
    view.frame.color.resize(camera_.width, camera_.height, 3);
    view.frame.depth.resize(camera_.width, camera_.height);
    view.landmarks.reserve(num_landmarks_);
  }

  std::vector<View> slots_;
  SpscRing<int> filled_;  // tracking -> understanding
  SpscRing<int> empty_;   // back
  PinholeCamera camera_;
  std::size_t num_landmarks_;
  int draft_ = -1;  // tracking thread
  int taken_ = -1;  // understanding thread
};

}  // namespace povslam
