# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What rules do on a robot beside relaying and recording: parameters, calls of services, and notices."""
