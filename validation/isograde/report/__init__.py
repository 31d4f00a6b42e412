"""What the grader writes: JSON lines, HTML, Markdown, JUnit XML, a badge."""
