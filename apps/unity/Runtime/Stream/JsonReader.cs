using System;
using System.Text;

namespace Shisei.Stream
{
    /// <summary>A text that is not the JSON that was expected.</summary>
    public sealed class JsonException : Exception
    {
        public JsonException(string message) : base(message) { }
    }

    /// <summary>
    /// Reads JSON forward, straight from the bytes of a message: no tree, and no garbage for numbers. Depth is limited,
    /// so that no message can exhaust the stack; whatever is not understood is skipped or refused, never guessed.
    /// </summary>
    public sealed class JsonReader
    {
        /// <summary>Objects and arrays inside each other; the stream needs four.</summary>
        public const int MostDepth = 16;

        private readonly bool[] started = new bool[MostDepth + 1];
        private readonly StringBuilder builder = new StringBuilder();
        private byte[] bytes = new byte[0];
        private int end;
        private int at;
        private int depth;
        private int keyStart;
        private int keyEnd;

        /// <summary>Begins anew with the first <paramref name="length"/> bytes of a message.</summary>
        public void Reset(byte[] message, int length)
        {
            bytes = message;
            end = length;
            at = 0;
            depth = 0;
        }

        /// <summary>True when a value of this first character comes next: { [ " n t f or - for numbers.</summary>
        public bool Next(char first)
        {
            byte here = Here();
            if (first == '-') return here == '-' || (here >= '0' && here <= '9');
            return here == first;
        }

        public void BeginObject() { Begin('{'); }

        public void BeginArray() { Begin('['); }

        /// <summary>Goes to the next key of an object; false behind the last.</summary>
        public bool NextKey()
        {
            if (!NextItem('}')) return false;
            if (Here() != '"') throw Wrong("a key");
            keyStart = at + 1;
            SkipString();
            keyEnd = at - 1;
            if (Here() != ':') throw Wrong(":");
            at++;
            return true;
        }

        /// <summary>Goes to the next item of an array; false behind the last.</summary>
        public bool NextItem() { return NextItem(']'); }

        /// <summary>True when the key just read is this one.</summary>
        public bool KeyIs(string key)
        {
            if (keyEnd - keyStart != key.Length) return false;
            for (int k = 0; k < key.Length; k++)
            {
                if (bytes[keyStart + k] != key[k]) return false;
            }
            return true;
        }

        /// <summary>A number; NaN for null and for anything else, which is skipped.</summary>
        public double Number()
        {
            if (!Next('-'))
            {
                Skip();
                return double.NaN;
            }
            bool negative = bytes[at] == '-';
            if (negative) at++;
            ulong digits = 0;
            int power = 0;
            int count = 0;
            bool fraction = false;
            for (; at < end; at++)
            {
                byte c = bytes[at];
                if (c == '.' && !fraction && count > 0) fraction = true;
                else if (c >= '0' && c <= '9')
                {
                    count++;
                    // nineteen digits fit; the rest only move the point
                    if (digits < 100000000000000000UL)
                    {
                        digits = digits * 10 + (ulong)(c - '0');
                        if (fraction) power--;
                    }
                    else if (!fraction) power++;
                }
                else break;
            }
            if (count == 0) throw Wrong("a number");
            if (at < end && (bytes[at] == 'e' || bytes[at] == 'E')) power += Exponent();
            double value = Scaled(digits, power);
            return negative ? -value : value;
        }

        /// <summary>A text of at most <paramref name="most"/> characters, the rest cut; null for anything else.</summary>
        public string Text(int most)
        {
            if (Here() != '"')
            {
                Skip();
                return null;
            }
            int start = at + 1;
            SkipString();
            int stop = at - 1;
            string text = Array.IndexOf(bytes, (byte)'\\', start, stop - start) < 0
                ? Encoding.UTF8.GetString(bytes, start, Math.Min(stop - start, 4 * most))
                : Unescaped(start, stop, most);
            return text.Length > most ? text.Substring(0, most) : text;
        }

        /// <summary>true; false for anything else.</summary>
        public bool True()
        {
            bool value = Here() == 't';
            Skip();
            return value;
        }

        /// <summary>Passes over the next value, whatever it is.</summary>
        public void Skip()
        {
            switch ((char)Here())
            {
                case '{':
                    BeginObject();
                    while (NextKey()) Skip();
                    break;
                case '[':
                    BeginArray();
                    while (NextItem()) Skip();
                    break;
                case '"':
                    SkipString();
                    break;
                case 't': Word("true"); break;
                case 'f': Word("false"); break;
                case 'n': Word("null"); break;
                default:
                    if (!Next('-')) throw Wrong("a value");
                    Number();
                    break;
            }
        }

        /// <summary>Refuses anything but white space behind the value.</summary>
        public void Finish()
        {
            while (at < end)
            {
                if (!White(bytes[at++])) throw Wrong("the end");
            }
        }

        private void Begin(char open)
        {
            if (Here() != open) throw Wrong(open.ToString());
            if (depth == MostDepth) throw new JsonException("too deep");
            at++;
            started[++depth] = false;
        }

        private bool NextItem(char close)
        {
            byte here = Here();
            if (here == close)
            {
                at++;
                depth--;
                return false;
            }
            if (started[depth])
            {
                if (here != ',') throw Wrong(",");
                at++;
            }
            started[depth] = true;
            return true;
        }

        private byte Here()
        {
            while (at < end && White(bytes[at])) at++;
            if (at >= end) throw Wrong("more");
            return bytes[at];
        }

        private void SkipString()
        {
            for (at++; at < end; at++)
            {
                byte c = bytes[at];
                if (c == '\\') at++;
                else if (c == '"')
                {
                    at++;
                    return;
                }
                else if (c < 0x20) break;
            }
            throw Wrong("the end of a text");
        }

        private string Unescaped(int start, int stop, int most)
        {
            builder.Length = 0;
            int k = start;
            while (k < stop && builder.Length < most)
            {
                int plain = k;
                while (k < stop && bytes[k] != '\\') k++;
                builder.Append(Encoding.UTF8.GetString(bytes, plain, k - plain));
                if (k >= stop) break;
                char escaped = (char)bytes[k + 1];
                k += 2;
                if (escaped == 'u')
                {
                    int code = 0;
                    for (int digit = 0; digit < 4; digit++)
                    {
                        int value = k + digit < stop ? HexValue(bytes[k + digit]) : -1;
                        if (value < 0) throw Wrong("four hexadecimal digits");
                        code = 16 * code + value;
                    }
                    builder.Append((char)code);
                    k += 4;
                    continue;
                }
                int which = "\"\\/bfnrt".IndexOf(escaped);
                if (which < 0) throw Wrong("an escape");
                builder.Append("\"\\/\b\f\n\r\t"[which]);
            }
            return builder.ToString();
        }

        private int Exponent()
        {
            at++;
            bool negative = at < end && bytes[at] == '-';
            if (at < end && (bytes[at] == '-' || bytes[at] == '+')) at++;
            int value = 0;
            int count = 0;
            for (; at < end && bytes[at] >= '0' && bytes[at] <= '9'; at++, count++)
            {
                if (value < 10000) value = 10 * value + bytes[at] - '0';
            }
            if (count == 0) throw Wrong("an exponent");
            return negative ? -value : value;
        }

        private static double Scaled(ulong digits, int power)
        {
            if (digits == 0 || power == 0) return digits;
            // up to 10^22 a power of ten is exact, so that one division rounds once
            if (power < 0 && power >= -22) return digits / Power(-power);
            if (power > 0 && power <= 22) return digits * Power(power);
            if (power > 400) return double.PositiveInfinity;
            if (power < -400) return 0;
            return digits * Math.Pow(10, power);
        }

        private static double Power(int of)
        {
            double value = 1;
            for (int k = 0; k < of; k++) value *= 10;
            return value;
        }

        private void Word(string word)
        {
            for (int k = 0; k < word.Length; k++)
            {
                if (at + k >= end || bytes[at + k] != word[k]) throw Wrong(word);
            }
            at += word.Length;
        }

        private static bool White(byte c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

        private static int HexValue(byte c)
        {
            if (c >= '0' && c <= '9') return c - '0';
            if (c >= 'a' && c <= 'f') return c - 'a' + 10;
            if (c >= 'A' && c <= 'F') return c - 'A' + 10;
            return -1;
        }

        private JsonException Wrong(string expected)
        {
            return new JsonException("at byte " + at + ": expected " + expected);
        }
    }
}
