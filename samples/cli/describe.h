// What a parameter may be, in words: for `info` and `nodes`.
#pragma once

#include <string>

#include "engine/params/params.h"

namespace radivox::cli {

std::string printAllowed(const params::Param& param);

}  // namespace radivox::cli
