#include "services/views/lab_file/sensor_list.hpp"

#include <gmock/gmock.h>

#include "services/views/lab_file/sensor_file.hpp"

namespace dyncal::inline views {
namespace {

using testing::HasSubstr;

const std::string head = "serial;name;manufacturer;model;interval_months;customer;customer_city;"
                         "customer_country;owner_identification\n";

std::string problem(const std::string& text) {
  const auto list = parse_sensor_list(text, "list.csv");
  EXPECT_FALSE(list) << text;
  return list ? "" : list.error().message;
}

TEST(SensorList, IsASensorFileForEachRow) {
  const auto list = parse_sensor_list(
      head + "S-1;accelerometer, digital;Works;MPU;12;Customer;Berlin;DE;Q 17\nS-2;a;b;c;;;;;\n",
      "list.csv");
  ASSERT_TRUE(list) << list.error().message;
  ASSERT_EQ(list->size(), 2U);
  const auto first = parse_sensor_file((*list)[0], "first");
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(first->serial, "S-1");
  EXPECT_EQ(first->name, "accelerometer, digital");
  EXPECT_EQ(first->interval_months, 12);
  EXPECT_EQ(first->owner_identification, "Q 17");
  ASSERT_TRUE(first->customer);
  EXPECT_EQ(first->customer->city, "Berlin");
  const auto second = parse_sensor_file((*list)[1], "second");
  ASSERT_TRUE(second) << second.error().message;
  EXPECT_FALSE(second->interval_months);
  EXPECT_FALSE(second->customer);
}

TEST(SensorList, RefusesWhatIsNone) {
  EXPECT_THAT(problem("serial,model\nS-1,M\n"), HasSubstr("list.csv:1: column 'name' is missing"));
  EXPECT_THAT(problem(head + "x\n"), HasSubstr("list.csv:2: has not the 9 fields of the head"));
  EXPECT_THAT(problem("serial,name,manufacturer,model,colour\nS,a,b,c,red\n"),
              HasSubstr("list.csv:1: column 'colour' is not known; columns are serial, name"));
  EXPECT_THAT(problem("serial,name,manufacturer,model\nS,a,b,c\nS,a,b,d\n"),
              HasSubstr("list.csv:3: serial number 'S' is there twice"));
  EXPECT_THAT(problem("serial,name,manufacturer,model\n,a,b,c\n"),
              HasSubstr("list.csv:2: key 'sensor.serial' is missing"));
  EXPECT_THAT(problem("serial,name,manufacturer,model,interval_months\nS,a,b,c,soon\n"),
              HasSubstr("list.csv:2: "));
  EXPECT_THAT(problem(head), HasSubstr("has no sensor"));
}

TEST(SensorList, WhatAFieldHoldsIsNeverTakenForKeys) {
  const auto list = parse_sensor_list(
      "serial,name,manufacturer,model\nS,\"a\"\"\nfirmware = 'x'\",b\\c,d\n", "l");
  ASSERT_TRUE(list) << list.error().message;
  const auto sensor = parse_sensor_file(list->front(), "x");
  ASSERT_TRUE(sensor) << sensor.error().message;
  EXPECT_EQ(sensor->name, "a\"\nfirmware = 'x'");
  EXPECT_EQ(sensor->manufacturer, "b\\c");
  EXPECT_EQ(sensor->firmware, "");
  EXPECT_THAT(problem("serial,name,manufacturer,model,interval_months\n"
                      "S,a,b,c,\"1\nfirmware = 'x'\"\n"),
              HasSubstr("is not a whole number of months"));
}

} // namespace
} // namespace dyncal::inline views
