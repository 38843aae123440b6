# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Actions of rules on a robot beside relaying and recording: parameters, calls of services, and notices."""
