// What every error must be: of the right code, one line, naming its subject.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "engine/error.h"

namespace radivox::tests {

template <class F>
Error catchError(F&& action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return Error(ErrorCode::BadInput, "");
}

inline void expectError(const Error& error, ErrorCode code, const std::string& part) {
  EXPECT_EQ(static_cast<int>(error.code()), static_cast<int>(code)) << error.what();
  EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what() << "\nlacks: " << part;
  EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "more than one line: " << error.what();
}

}  // namespace radivox::tests
