#include "daemon/understanding_unit.hpp"

#include <utility>

#include "daemon/config_file_classes.hpp"
#include "daemon/config_file_network.hpp"

namespace povslam {
namespace {

constexpr int kViewSlots = 3;
constexpr std::size_t kOwners = 4096, kBeliefs = 1024;  // some views' worth

// A camera's labels are the sensor right after it.
bool delivers_labels(const DriverSetup& setup) {
  return setup.sensors.size() > 1 && setup.sensors[1].kind == SensorKind::labels;
}

}  // namespace

Result<std::string> resolve_labels(const AppConfig& config, const DriverSetup& setup) {
  const std::string& asked = config.pipeline.understanding.labels;
  if (asked == "off" || by_geometry(config.pipeline.understanding)) return asked;
  const bool any = delivers_labels(setup) || !config.labels.socket.empty() || !config.labels.lcm_channel.empty();
  if (any) return std::string("replay");
  if (asked == "auto") return std::string("geometric");
  return Error{"understanding.labels: \"" + asked + "\", but " + setup.description +
               " delivers no labels; set its option labels = true, labels.socket or labels.lcm_channel, or geometric"};
}

Result<std::unique_ptr<UnderstandingUnit>> UnderstandingUnit::start(const AppConfig& config, const DriverSetup& setup,
                                                                    const WorldContent* content, const Links& links) {
  const Result<std::string> labels = resolve_labels(config, setup);
  if (!labels) return labels.error();
  if (*labels == "off") return std::unique_ptr<UnderstandingUnit>();
  const bool by_labels = *labels == "replay";
  Result<ClassTable> classes = by_labels ? choose_class_table(config.labels, setup.label_table) : geometric_classes();
  if (!classes) return classes.error();
  std::unique_ptr<SegmentNamer> namer;
  if (*labels == "dnn") {
    auto loaded = load_namer(config);
    if (!loaded) return loaded.error();
    namer = std::move(*loaded);
  }
  const std::string table = classes->name;
  UnderstandingOptions options = config.pipeline.understanding;
  options.labels = *labels;
  std::unique_ptr<UnderstandingUnit> unit(
      new UnderstandingUnit(config, options, setup, std::move(*classes), content, std::move(namer), links));
  if (by_labels) {
    auto sources = LabelSources::start(config.labels, config.lcm, table, setup.sensors[0].camera, &links.bell);
    if (!sources) return sources.error();
    if ((*sources)->any()) unit->sources_ = std::move(*sources);
    unit->sensor_labels_used_ = delivers_labels(setup);
  }
  if (links.mesh_wanted) unit->understanding_.keep_loose_surface();
  links.pipeline.take_restored(unit->understanding_);
  unit->thread_.emplace(unit->understanding_,
                        UnderstandingLinks{links.bell, unit->views_, unit->sensor_labels_, unit->sources_.get(),
                                           unit->owners_, unit->beliefs_, links.reports, links.changes});
  return unit;
}

UnderstandingUnit::UnderstandingUnit(const AppConfig& config, const UnderstandingOptions& options,
                                     const DriverSetup& setup, ClassTable classes, const WorldContent* content,
                                     std::unique_ptr<SegmentNamer> namer, const Links& links)
    : views_(kViewSlots, setup.sensors[0].camera, static_cast<std::size_t>(config.pipeline.frontend.orb.num_features),
             &links.bell),
      sensor_labels_(kLabelRing, &links.bell),
      owners_(kOwners),
      beliefs_(kBeliefs),
      understanding_(options, setup.sensors[0], std::move(classes), content, std::move(namer)) {}

void UnderstandingUnit::finish() {
  if (thread_) thread_->finish();
  sources_.reset();
}

}  // namespace povslam
