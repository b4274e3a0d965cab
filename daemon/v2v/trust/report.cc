// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/report.h"

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
  report.evidence = {{finding.quantity, finding.value}, {"limit", finding.limit}};
  return report;
}

}  // namespace v2vouch
