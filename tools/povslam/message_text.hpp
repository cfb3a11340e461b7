// The daemon's messages as one line of text each.
#pragma once

#include <bot_core/pose_t.hpp>
#include <povslam/health_t.hpp>
#include <povslam/object_event_t.hpp>
#include <povslam/object_list_t.hpp>
#include <povslam/pose_t.hpp>
#include <string>

namespace povslam {

const char* state_name(int state);  // of pose_t and health_t; "?" for one of another version
std::string pose_line(const pose_t& message);
std::string bot_core_pose_line(const bot_core::pose_t& message);
std::string health_line(const health_t& message);
std::string event_line(const object_event_t& message);
std::string object_line(const object_t& object);

}  // namespace povslam
