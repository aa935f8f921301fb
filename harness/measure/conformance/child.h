#pragma once

#include "measure/conformance/rule.h"
#include "measure/worker/worker_process.h"

namespace gnomon::conformance {

/// Checks one rule of a technique in a process of its own: a crash, a hang or corrupted memory is a finding, and harms no other
/// rule. `options` names the plugins that the other process loads. Throws WorkerFailure where there is no program to start.
Verdict judge_in_child(const Rule& rule, const TechniqueEntry& entry, WorkerOptions options, double timeout_seconds);

/// The other side: answers {"do": RULE, "technique": ID, "place": FILE} on `socket` by verdict_json, and writes to the file the
/// place where it checks the technique.
int rule_child_main(int socket, int threads);

Json verdict_json(const Verdict& verdict);
Verdict verdict_of(const Json& json);

}  // namespace gnomon::conformance
