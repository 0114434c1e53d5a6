// What was found, as a system file and the file of holes beside it.
#pragma once

#include "maide/extract/extract.hpp"
#include "maide/extract/model.hpp"

namespace maide::extract {

void write_system(const Model& model, const ExtractOptions& options, Extracted& result);

}  // namespace maide::extract
