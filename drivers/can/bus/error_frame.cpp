#include "drivers/can/bus/error_frame.hpp"

#include <linux/can/error.h>

namespace dyncal::drivers::can {

namespace {

#ifndef CAN_ERR_CNT
constexpr std::uint32_t CAN_ERR_CNT = 0x200U; // newer than the oldest kernel headers we build with
#endif

void add(std::string& text, const char* words) {
  if (!text.empty()) {
    text += ", ";
  }
  text += words;
}

void read_controller(std::uint8_t bits, BusFault& fault) {
  if (bits & CAN_ERR_CRTL_RX_OVERFLOW) {
    add(fault.cause, "controller overrun");
    fault.frames_lost = true;
  }
  if (bits & CAN_ERR_CRTL_TX_OVERFLOW) {
    add(fault.cause, "transmit buffer full");
  }
  if (bits & CAN_ERR_CRTL_ACTIVE) {
    add(fault.cause, "error active again");
    fault.state = BusState::error_active;
  }
  if (bits & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) {
    add(fault.cause, "error warning");
    fault.state = BusState::error_warning;
  }
  if (bits & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) {
    add(fault.cause, "error passive");
    fault.state = BusState::error_passive;
  }
}

void read_protocol(std::uint8_t kind, std::uint8_t place, BusFault& fault) {
  if (kind & CAN_ERR_PROT_STUFF) {
    add(fault.cause, "stuff error");
  }
  if (kind & CAN_ERR_PROT_FORM) {
    add(fault.cause, "form error");
  }
  if (kind & (CAN_ERR_PROT_BIT | CAN_ERR_PROT_BIT0 | CAN_ERR_PROT_BIT1)) {
    add(fault.cause, "bit error");
  }
  if (place == CAN_ERR_PROT_LOC_CRC_SEQ || place == CAN_ERR_PROT_LOC_CRC_DEL) {
    add(fault.cause, "checksum error");
  }
  if (kind == 0 && fault.cause.empty()) {
    add(fault.cause, "protocol error");
  }
}

} // namespace

BusFault bus_fault(std::uint32_t classes, std::span<const std::uint8_t, 8> data) {
  BusFault fault;
  if (classes & CAN_ERR_CRTL) {
    read_controller(data[1], fault);
  }
  if (classes & CAN_ERR_PROT) {
    read_protocol(data[2], data[3], fault);
  }
  if (classes & CAN_ERR_ACK) {
    add(fault.cause, "no acknowledgment");
  }
  if (classes & CAN_ERR_LOSTARB) {
    add(fault.cause, "lost arbitration");
  }
  if (classes & CAN_ERR_TRX) {
    add(fault.cause, "transceiver fault");
  }
  if (classes & CAN_ERR_TX_TIMEOUT) {
    add(fault.cause, "transmission timed out");
  }
  if (classes & CAN_ERR_BUSOFF) {
    add(fault.cause, "bus-off");
    fault.state = BusState::bus_off;
  }
  if (classes & CAN_ERR_RESTARTED) {
    add(fault.cause, "controller restarted");
    fault.state = BusState::error_active;
  }
  if (fault.cause.empty()) {
    add(fault.cause, "bus error");
  }
  if (classes & CAN_ERR_CNT) {
    fault.transmit_errors = data[6];
    fault.receive_errors = data[7];
  }
  return fault;
}

} // namespace dyncal::drivers::can
