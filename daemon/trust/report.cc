// SPDX-License-Identifier: Apache-2.0
#include "daemon/trust/report.h"

#include "daemon/trust/standard_classes.h"

namespace v2vouch {

MisbehaviorReport ReportOf(const SenderTrust::Judgement& judgement, SenderId sender,
                           const CertificateDigest& certificate, Timestamp stamp) {
  const Finding& finding = judgement.finding;
  MisbehaviorReport report;
  report.stamp = stamp;
  report.sender = sender;
  report.certificate = certificate;
  report.check = finding.check;
  report.verdict = judgement.verdict;
  if (const auto standard = StandardClassOf(report.check)) {
    report.etsi_class = standard->etsi_class;
    report.is_j3287 = standard->is_j3287;
  }
  report.evidence = {{finding.quantity, finding.value}, {"limit", finding.limit}};
  return report;
}

}  // namespace v2vouch
