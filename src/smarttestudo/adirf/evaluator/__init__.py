# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The one evaluator: values of signals to a wished rate for each topic, incrementally."""
