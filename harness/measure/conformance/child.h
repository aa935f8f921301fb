#pragma once
#include <string>

#include "measure/conformance/rule.h"
#include "measure/worker/worker_process.h"

namespace gnomon::conformance {

/// Asks a technique one rule in a process of its own: a crash, a hang or what it does to memory is a finding, and costs no
/// other rule. `options` says with which plugins the other process knows it, too. Throws WorkerFailure where there is no
/// program to start.
Verdict judge_in_child(const Rule& rule, const TechniqueEntry& entry, WorkerOptions options, double timeout_seconds);

/// The other side: answers {"do": RULE, "technique": ID, "place": FILE} on `socket` by verdict_json, and keeps in the file
/// where the technique is being asked.
int rule_child_main(int socket, int threads);

Json verdict_json(const Verdict& verdict);
Verdict verdict_of(const Json& json);

}  // namespace gnomon::conformance
