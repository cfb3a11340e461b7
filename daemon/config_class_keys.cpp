#include "daemon/config_class_keys.hpp"

namespace povslam {

namespace {

template <class Value>
Key<ClassEntry> key(const char* path, Value& (*member)(ClassEntry&), const char* doc, double min, double max,
                    std::vector<std::string> choices = {}) {
  return {path, Member<ClassEntry>(member), doc, min, max, std::move(choices)};
}

template <auto kMember>
auto& at(ClassEntry& entry) {
  return entry.*kMember;
}

}  // namespace

std::span<const Key<ClassEntry>> class_keys() {
  using E = ClassEntry;
  static const std::vector<Key<ClassEntry>> keys = {
      key<int>("id", at<&E::id>, "Value of its pixels in label images", 0, 255),
      key<std::string>("name", at<&E::name>, "Stands in events", 1, 64),
      key<std::string>("kind", at<&E::kind>, "How it is wont to change", 1, 64,
                       {"ignore", "structure", "static_object", "semi_static", "dynamic"}),
      key<double>("prior_alpha", at<&E::prior_alpha>, "Beta prior of its consistency", 0.01, 1000),
      key<double>("prior_beta", at<&E::prior_beta>, "The same", 0.01, 1000),
      key<double>("k_inlier", at<&E::k_inlier>, "POCD's k when the geometry agrees", 0, 100),
      key<double>("k_outlier", at<&E::k_outlier>, "and when it does not", 0, 100),
      key<double>("min_extent_m", at<&E::min_extent_m>, "Largest side of its box, at least", 0, 1000),
      key<double>("max_extent_m", at<&E::max_extent_m>, "and at most", 0, 1000),
      key<bool>("one_piece", at<&E::one_piece>, "Made of parts that stand apart: grooves in it separate nothing", 0, 1),
      key<std::array<double, 3>>("rgb", at<&E::rgb>, "Its colour in pictures", 0, 255),
  };
  return keys;
}

}  // namespace povslam
