// Keys of variational EM: its windows, its formulas, its end.
#include "daemon/config_keys_rows.hpp"

namespace povslam {

// An option added to these structs changes their size: give it a key below, then the new size here.
static_assert(sizeof(VemOptions) == 168 && sizeof(WindowOptions) == 96);

namespace {

std::vector<Key<AppConfig>> window_table() {
  return {
      key("window.every_frames", AT(pipeline.window.every_frames), 0, 1000,
          "Frames from one in the window to the next; each is solved for; 0: objects are not inferred from tracking"),
      key("window.delay_frames", AT(pipeline.window.delay_frames), 1, 1000,
          "The answer enters this many frames after it was asked for; one that is late, when it comes"),
      key("window.frames", AT(pipeline.window.frames), 1, 16, "In the window"),
      key("window.max_matches", AT(pipeline.window.max_matches), 50, 20000,
          "Of a frame; where there are more, objects that have many give up theirs first"),
      key("window.vo_sigma_m", AT(pipeline.window.vo_sigma_m), 1e-4, 10.0, "Of odometry between two of its frames"),
      key("window.vo_sigma_rad", AT(pipeline.window.vo_sigma_rad), 1e-4, 3.2, "Likewise"),
      key("window.prior_sigma_m", AT(pipeline.window.prior_sigma_m), 1e-4, 10.0, "Of the oldest frame's pose"),
      key("window.prior_sigma_rad", AT(pipeline.window.prior_sigma_rad), 1e-4, 3.2, "Likewise"),
      key("window.match_sigma_m", AT(pipeline.window.match_sigma_m), 1e-3, 1.0,
          "Of a point matched to a landmark, beside the noise of its depth"),
      key("window.reach_m", AT(pipeline.window.reach_m), 0.0, 4.0,
          "An object not found where it should be is looked for so far around"),
      key("window.verdicts", AT(pipeline.window.verdicts), 1, 100,
          "Windows that must agree before an object is doubted, or believed again"),
      key("window.correct_m", AT(pipeline.window.correct_m), 1e-3, 10.0,
          "A pose that differs by less from tracking's is left to tracking"),
      key("window.correct_rad", AT(pipeline.window.correct_rad), 1e-3, 3.2, "Likewise"),
      key("window.correct_matches", AT(pipeline.window.correct_matches), 4, 20000,
          "Accepted matches without which tracking's pose is not corrected"),
  };
}

std::vector<Key<AppConfig>> paper_table() {
  return {
      {"vem.solver",
       Row<AppConfig>::at(AT_CHOICE(pipeline.backend.vem.solver)),
       "ceres: the reference, a hundred times slower",
       0,
       1,
       {"structured", "ceres"}},
      {"vem.weights",
       Row<AppConfig>::at(AT_CHOICE(pipeline.backend.vem.weights)),
       "Responsibilities by E[log v], or by log E[v]",
       0,
       1,
       {"elbo", "single_point"}},
      {"vem.uniform_measure",
       Row<AppConfig>::at(AT_CHOICE(pipeline.backend.vem.uniform_measure)),
       "Density of an outlier: over the norm of its error, or over the ball",
       0,
       1,
       {"norm", "ball"}},
      {"vem.gate",
       Row<AppConfig>::at(AT_CHOICE(pipeline.backend.vem.gate)),
       "What decides the max-mixture",
       0,
       1,
       {"expected_v", "expected_pi", "none"}},
      {"vem.pool",
       Row<AppConfig>::at(AT_CHOICE(pipeline.backend.vem.pool)),
       "One responsibility for each",
       0,
       1,
       {"landmark", "object"}},
      {"vem.em_state",
       Row<AppConfig>::at(AT_CHOICE(pipeline.backend.vem.em_state)),
       "What of a belief goes on from one iteration to the next",
       0,
       1,
       {"held", "none", "beta", "full"}},
      key("vem.mean_field", AT(pipeline.backend.vem.mean_field), 0, 1,
          "The whole coordinate ascent: beliefs take the responsibilities in"),
  };
}

std::vector<Key<AppConfig>> loop_table() {
  return {
      key("vem.sigma_rigid_m", AT(pipeline.backend.vem.sigma_rigid_m), 1e-4, 10.0, "Of rigidity"),
      key("vem.sigma_prior_m", AT(pipeline.backend.vem.sigma_prior_m), 1e-4, 10.0,
          "Of a landmark where the map has it"),
      key("vem.e_max_m", AT(pipeline.backend.vem.e_max_m), 0.01, 100.0, "Largest error of an outlier"),
      key("vem.max_iterations", AT(pipeline.backend.vem.max_iterations), 1, 1000, "Of EM"),
      key("vem.steps", AT(pipeline.backend.vem.steps), 1, 100, "Of Gauss-Newton in each M-step"),
      key("vem.stop_m", AT(pipeline.backend.vem.stop_m), 0.0, 1.0, "It ends when no pose moves further"),
      key("vem.stop_rad", AT(pipeline.backend.vem.stop_rad), 0.0, 1.0, "Likewise"),
      key("vem.stop_consistency", AT(pipeline.backend.vem.stop_consistency), 0.0, 1.0,
          "And no object's consistency changes by more"),
      key("vem.burn_in", AT(pipeline.backend.vem.burn_in), 0, 1000, "Iterations without gate"),
      key("vem.hold_belief", AT(pipeline.backend.vem.hold_belief), 0, 1000, "Iterations with beliefs as stored"),
      key("vem.anneal_sigma_m", AT(pipeline.backend.vem.anneal_sigma_m), 0.0, 10.0,
          "Sigma of matches at first; 0: their own"),
      key("vem.anneal_factor", AT(pipeline.backend.vem.anneal_factor), 0.01, 0.99, "By which it falls each iteration"),
      key("vem.other_starts", AT(pipeline.backend.vem.other_starts), 0, 16,
          "Tried at most where a window's own start leaves much unexplained; the largest ELBO is taken; 0: none"),
      key("vem.doubtful_share", AT(pipeline.backend.vem.doubtful_share), 0.0, 1.0,
          "Of all matches: that is when more are rejected"),
      key("vem.accept_share", AT(pipeline.backend.vem.accept_share), 0.0, 1.0,
          "Of an object's matches that must be accepted for the object to be"),
      key("vem.accept_matches", AT(pipeline.backend.vem.accept_matches), 1, 1000, "And at least so many"),
  };
}

}  // namespace

std::vector<Key<AppConfig>> vem_table() {
  std::vector<Key<AppConfig>> all = window_table();
  for (const auto& part : {paper_table(), loop_table()}) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace povslam
