"""usd-validation-nvidia: a stage in ``stage``; answers the ``issues`` that its rules find, without mere information."""

from __future__ import annotations

from typing import Any

from loop import answer_all
from usd_validation_nvidia import IssueSeverity, ValidationEngine


def validate(job: dict[str, Any]) -> dict[str, Any]:
    """Every rule that is on by default."""
    found = ValidationEngine().validate(job["stage"])
    return {
        "issues": [
            f"{issue.rule.__name__ if issue.rule else '?'}: {issue.severity.name}: {issue.message} {issue.at or ''}"
            for issue in found.issues()
            if issue.severity not in (IssueSeverity.NONE, IssueSeverity.INFO)
        ]
    }


if __name__ == "__main__":
    answer_all(validate)
