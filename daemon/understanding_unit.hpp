// All that understanding needs beside tracking: where labels come from, the hand-offs, Understanding and its thread.
#pragma once

#include <memory>
#include <optional>

#include "daemon/label_sources.hpp"
#include "daemon/understanding_thread.hpp"
#include "drivers/driver.hpp"
#include "pipeline/pipeline.hpp"

namespace povslam {

class UnderstandingUnit {
 public:
  struct Links {
    Doorbell& bell;  // rung when a stored change comes back; all outlive the unit
    ReportRing& reports;
    Pipeline& pipeline;                         // told of an earlier session's objects before its first frame
    ChangeWay<WorldChange>* changes = nullptr;  // to the disk; null: nobody stores
    bool mesh_wanted = false;                   // see AppOptions
  };

  // Starts label sources and the thread. content: an earlier session's, or null. Null: understanding.labels is off.
  // Fails when what is asked for gives no labels or no names, with the key and the remedy.
  static Result<std::unique_ptr<UnderstandingUnit>> start(const AppConfig& config, const DriverSetup& setup,
                                                          const WorldContent* content, const Links& links);
  ~UnderstandingUnit() { finish(); }

  // For tracking and the sensor.
  ViewExchange& views() { return views_; }
  OwnerRing& owners() { return owners_; }
  BeliefRing& beliefs() { return beliefs_; }
  LabelRing* sensor_labels() { return sensor_labels_used_ ? &sensor_labels_ : nullptr; }

  // Once tracking and the sensor have stopped: ends the session, stops the thread, then the label sources.
  void finish();
  // After finish(): as of UnderstandingThread.
  WorldChange* rest() { return thread_->rest(); }
  void stored(WorldChange* change) { thread_->stored(change); }
  Understanding& understanding() { return understanding_; }

 private:
  UnderstandingUnit(const AppConfig& config, const UnderstandingOptions& options, const DriverSetup& setup,
                    ClassTable classes, const WorldContent* content, std::unique_ptr<SegmentNamer> namer,
                    const Links& links);

  ViewExchange views_;
  LabelRing sensor_labels_;
  OwnerRing owners_;
  BeliefRing beliefs_;
  bool sensor_labels_used_ = false;
  Understanding understanding_;
  std::unique_ptr<LabelSources> sources_;
  std::optional<UnderstandingThread> thread_;
};

// The source that understanding.labels means where it says auto: labels, if the driver or the configuration has any,
// else geometric. Fails when labels are asked for and nothing delivers them.
Result<std::string> resolve_labels(const AppConfig& config, const DriverSetup& setup);

}  // namespace povslam
