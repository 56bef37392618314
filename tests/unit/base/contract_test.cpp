// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/contract.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "pamr/base/types.hpp"

namespace pamr {
namespace contract_test {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Contract, KeepsSilentWhenTheConditionHolds) {
  int evaluations = 0;

  PAMR_EXPECTS(++evaluations == 1);
  PAMR_ENSURES(++evaluations == 2);

  EXPECT_EQ(evaluations, 2);
}

TEST(Contract, NamesTheConditionAndThePlaceWhenThePreconditionIsBroken) {
  EXPECT_THAT([] { PAMR_EXPECTS(1 + 1 == 3); },
              ThrowsMessage<ContractViolation>(
                  AllOf(HasSubstr("precondition"), HasSubstr("1 + 1 == 3"), HasSubstr("contract_test.cpp"))));
}

TEST(Contract, TellsAPostconditionFromAPrecondition) {
  EXPECT_THAT([] { PAMR_ENSURES(false); }, ThrowsMessage<ContractViolation>(HasSubstr("postcondition")));
}

TEST(Narrow, KeepsTheValueAtBothEndsOfTheTargetType) {
  EXPECT_EQ(narrow<LocalId>(GlobalId{2147483647}), 2147483647);
  EXPECT_EQ(narrow<LocalId>(GlobalId{-2147483648}), std::numeric_limits<LocalId>::min());
}

TEST(Narrow, RefusesTheFirstValueBeyondTheTargetType) {
  EXPECT_THROW(narrow<LocalId>(GlobalId{2147483648}), ContractViolation);
  EXPECT_THROW(narrow<LocalId>(GlobalId{-2147483649}), ContractViolation);
}

TEST(Narrow, RefusesAChangeOfSign) {
  EXPECT_THROW(narrow<std::uint64_t>(GlobalId{-1}), ContractViolation);
  EXPECT_THROW(narrow<GlobalId>(std::numeric_limits<std::uint64_t>::max()), ContractViolation);
}

}  // namespace contract_test
}  // namespace pamr
