// Binary frames: COBS between zero bytes, CRC-16/CCITT-FALSE (polynomial 0x1021, start 0xFFFF) at the end, all
// numbers little-endian. No Arduino, no NuttX.
//
//   sample (type 1): u8 type, u16 sequence, u32 timestamp, f32 temperature, 3 f32 gyro, 3 f32 acceleration
//   block  (type 2): u8 type, u16 sequence, u16 readings, u32 first timestamp, u32 last timestamp, u32 dropped,
//                    f32 temperature, 3 f64 gyro, 3 f32 acceleration: means over the block
//   status (type 3): u8 type, u16 sequence, u32 frames dropped, u32 readings missed by the sensor's memory
//
// The sequence counts every frame that should have been sent, so each loss shows.
#pragma once
#include <stddef.h>
#include <stdint.h>
#include <string.h>

static const size_t MAX_PAYLOAD = 64;
static const size_t MAX_FRAME = MAX_PAYLOAD + 2 + 3;

inline uint16_t crc16(const uint8_t *data, size_t n) {
  uint16_t crc = 0xFFFF;
  for (size_t i = 0; i < n; ++i) {
    crc ^= static_cast<uint16_t>(data[i]) << 8;
    for (int b = 0; b < 8; ++b) crc = (crc & 0x8000) ? (crc << 1) ^ 0x1021 : crc << 1;
  }
  return crc;
}

// Writes the frame with its closing zero; returns its length. n is at most MAX_PAYLOAD.
inline size_t encode_frame(const uint8_t *payload, size_t n, uint8_t *out) {
  uint8_t raw[MAX_PAYLOAD + 2];
  memcpy(raw, payload, n);
  const uint16_t crc = crc16(payload, n);
  raw[n] = crc & 0xFF;
  raw[n + 1] = crc >> 8;
  size_t at = 1, code_at = 0;
  uint8_t code = 1;
  for (size_t i = 0; i < n + 2; ++i) {
    if (raw[i] == 0) {
      out[code_at] = code;
      code_at = at++;
      code = 1;
    } else {
      out[at++] = raw[i];
      ++code;
    }
  }
  out[code_at] = code;
  out[at++] = 0;
  return at;
}

class Payload {
public:
  explicit Payload(uint8_t type, uint16_t sequence) {
    put(type);
    put(sequence);
  }
  template <typename T> void put(T value) { // both the board and the test host are little-endian
    memcpy(bytes_ + size_, &value, sizeof(value));
    size_ += sizeof(value);
  }
  const uint8_t *bytes() const { return bytes_; }
  size_t size() const { return size_; }

private:
  uint8_t bytes_[MAX_PAYLOAD] = {0};
  size_t size_ = 0;
};
