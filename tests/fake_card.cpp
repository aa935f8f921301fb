// What stands for NVIDIA's management library in tests: two cards, of which the second tells less.
#include <cstdint>
#include <cstring>
#include <string>

namespace {
constexpr int success = 0, not_supported = 3;
int opened = 0;
/// Cards are numbers from 1.
std::uintptr_t number(void* card) { return reinterpret_cast<std::uintptr_t>(card); }
int answer(unsigned* value, unsigned what, bool is_known = true) {
  if (opened != 1 || !is_known) return not_supported;
  *value = what;
  return success;
}
int answer(char* text, unsigned length, const std::string& what) {
  if (opened != 1 || what.size() >= length) return not_supported;
  std::strcpy(text, what.c_str());
  return success;
}
}  // namespace

extern "C" {
int nvmlInit_v2() { return ++opened, success; }
int nvmlShutdown() { return --opened, success; }
int nvmlDeviceGetCount_v2(unsigned* count) { return answer(count, 2); }
int nvmlDeviceGetHandleByIndex_v2(unsigned index, void** card) {
  *card = reinterpret_cast<void*>(static_cast<std::uintptr_t>(index + 1));
  return success;
}
int nvmlDeviceGetName(void* card, char* name, unsigned length) {
  return answer(name, length, number(card) == 1 ? "NVIDIA Abacus 10" : "NVIDIA Slide Rule");
}
int nvmlSystemGetDriverVersion(char* version, unsigned length) { return answer(version, length, "1.2.3"); }
int nvmlDeviceGetClockInfo(void* card, int which, unsigned* mhz) {
  return answer(mhz, which == 0 ? 1500 : 7000, number(card) == 1);
}
int nvmlDeviceGetPowerUsage(void* card, unsigned* milliwatts) { return answer(milliwatts, 123456, number(card) == 1); }
int nvmlDeviceGetEnforcedPowerLimit(void*, unsigned* milliwatts) { return answer(milliwatts, 350000); }
// It has no nvmlDeviceGetTemperature.
}
