#include "maide/check/model_usage.hpp"

namespace maide {
namespace {

bool cuts(const ModelInstance& model, Symbol input) {
  if (model.when_unexplored != WhenUnexplored::stop) return false;
  for (StateId state = 0; state < model.automaton.size(); ++state) {
    if (model.automaton.is_quiescent(state) && is_beyond_learned(model.automaton, state, input)) {
      return true;
    }
  }
  return false;
}

}  // namespace

ModelUsage::ModelUsage(const System& system) : instances(system.models.size()) {
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      if (edge.kind == ProgramEdge::Kind::quiet) instances[edge.model].quiet = true;
      if (edge.kind != ProgramEdge::Kind::give) continue;
      if (!instances[edge.model].inputs.insert(edge.symbol).second) continue;
      if (!cuts(system.models[edge.model], edge.symbol)) continue;
      instances[edge.model].cutting.insert(edge.symbol);
      any_cut = true;
    }
  }
}

}  // namespace maide
