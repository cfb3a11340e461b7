// LCM channels of the daemon's messages.
#pragma once

namespace povslam {

inline constexpr const char* kPoseChannel = "POVSLAM_POSE";                 // povslam.pose_t
inline constexpr const char* kHealthChannel = "POVSLAM_HEALTH";             // povslam.health_t
inline constexpr const char* kObjectEventChannel = "POVSLAM_OBJECT_EVENT";  // povslam.object_event_t
inline constexpr const char* kObjectsChannel = "POVSLAM_OBJECTS";           // povslam.object_list_t
inline constexpr const char* kBotCorePoseChannel = "POSE";                  // bot_core.pose_t

}  // namespace povslam
