#pragma once
// What the sketch uses of Arduino's interface.
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#define PI 3.1415926535897932384626433832795
void delay(unsigned long ms);
unsigned long millis(void);
class SerialPort {
public:
  void begin(long baud);
  void println(const char *text);
  size_t write(const uint8_t *bytes, size_t n);
  int availableForWrite();
  int available();
  int read();
};
extern SerialPort Serial;
void setup();
void loop();
