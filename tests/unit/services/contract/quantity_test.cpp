#include "services/contract/quantity.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

TEST(Quantity, FollowsFromTheDimensionOfTheUnit) {
  const std::pair<const char*, Quantity> units[] = {
      {"m/s^2", Quantity::acceleration},
      {R"(\metre\per\second\tothe{2})", Quantity::acceleration},
      {R"(\newton\kilogram\tothe{-1})", Quantity::acceleration},
      {"m/s", Quantity::velocity},
      {R"(\milli\metre\second\tothe{-1})", Quantity::velocity},
      {"m", Quantity::displacement},
      {R"(\micro\metre)", Quantity::displacement},
      {"rad", Quantity::angle},
      {R"(\degree)", Quantity::angle},
      {"rad/s", Quantity::angular_velocity},
      {R"(\degree\per\second)", Quantity::angular_velocity},
      {R"(\degree\second\tothe{-2})", Quantity::angular_acceleration},
      {"Hz", Quantity::frequency},
      {"N", Quantity::force},
      {"N m", Quantity::torque},
      {R"(\joule)", Quantity::torque},
      {"Pa", Quantity::pressure},
      {R"(\milli\bar)", Quantity::pressure},
      {"uT", Quantity::magnetic_flux_density},
      {"V", Quantity::voltage},
      {"mV", Quantity::voltage},
      {R"(\watt\per\ampere)", Quantity::voltage},
      {R"(\milli\ampere)", Quantity::current},
      {R"(\pico\coulomb)", Quantity::charge},
      {R"(\ohm)", Quantity::other_electrical},
      {R"(\volt\metre\tothe{-1}\second\tothe{2})", Quantity::other_electrical},
      {"degC", Quantity::temperature},
      {"K", Quantity::temperature},
      {"s", Quantity::time},
      {R"(\hour)", Quantity::time},
      {R"(\watt)", Quantity::other},
  };
  for (const auto& [unit, quantity] : units) {
    EXPECT_STREQ(to_string(quantity_of_unit(unit)), to_string(quantity)) << unit;
  }
}

TEST(Quantity, IsNotKnownWithoutAUnitThatTells) {
  for (const char* unit : {"", "1", R"(\one)", R"(\percent)", R"(\metre\per\metre)", "g", "LSB",
                           R"(\A.U.)", "furlong", R"(\decibel)"}) {
    EXPECT_EQ(quantity_of_unit(unit), Quantity::unknown) << unit;
  }
}

TEST(Quantity, FollowsFromTheWordsOfInstruments) {
  EXPECT_EQ(quantity_of_word("Voltage"), Quantity::voltage);
  EXPECT_EQ(quantity_of_word("X Acceleration"), Quantity::acceleration);
  EXPECT_EQ(quantity_of_word("Z Angular velocity"), Quantity::angular_velocity);
  EXPECT_EQ(quantity_of_word("Angular acceleration"), Quantity::angular_acceleration);
  EXPECT_EQ(quantity_of_word("temperature"), Quantity::temperature);
  EXPECT_EQ(quantity_of_word(R"(\volt)"), Quantity::voltage);
  EXPECT_EQ(quantity_of_word(""), Quantity::unknown);
  EXPECT_EQ(quantity_of_word("Channel 3"), Quantity::unknown);
}

} // namespace
} // namespace dyncal::inline contract
